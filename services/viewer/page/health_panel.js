// How every service is doing, and which of them has fallen silent.

const kMegabyte = 1e6;

function milliseconds(value) {
  return value >= 100 ? value.toFixed(0) : value.toFixed(1);
}

export class HealthPanel {
  constructor() {
    this.body = document.querySelector('#health tbody');
    this.silent = document.getElementById('silent');
    this.services = [];
  }

  take({json}) {
    this.services = JSON.parse(new TextDecoder().decode(json));
    this.body.innerHTML = '';
    for (const service of this.services) this.body.append(this.row(service));
    const silent = this.services.filter((service) => service.silent);
    const names = silent.length > 2 ? silent.length : silent.map((service) => service.service.replace(/_/g, ' ')).join(', ');
    this.silent.textContent = silent.length > 0 ? `${names} silent` : '';
  }

  row(service) {
    const row = document.createElement('tr');
    const ended = service.state === 'ended';
    row.className = service.silent ? 'silent' : ended ? 'ended' : '';
    row.title = `${service.host}, process ${service.pid}, ${service.state}` +
        (service.last_rejection ? `; last refused: ${service.last_rejection}` : '');
    const cells = [
      [service.service.replace(/_/g, ' ')],
      [service.silent ? `${service.silent_for.toFixed(0)} s` : ended ? 'ended' : service.rate.toFixed(1)],
      ...[service.p50, service.p90, service.p99].map((time) => [service.silent ? '–' : milliseconds(time)]),
      [service.dropped, service.dropped > 0],
      [service.rejected, service.rejected > 0],
      [service.silent || ended ? '–' : `${(100 * service.cpu).toFixed(0)} %`],
      [(service.memory / kMegabyte).toFixed(0)],
    ];
    for (const [text, attention] of cells) {
      const cell = document.createElement('td');
      cell.textContent = text;
      if (attention) cell.className = 'attention';
      row.append(cell);
    }
    return row;
  }
}
