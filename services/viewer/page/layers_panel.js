// Switches of the layers, with how much is in each.

export class LayersPanel {
  /** @param layers [{name, label, colour, layer, visible}] */
  constructor(layers, onSwitch) {
    this.rows = layers.map((entry) => this.row(entry, onSwitch));
  }

  row({name, label, colour, layer, visible}, onSwitch) {
    const row = document.createElement('label');
    const box = document.createElement('input');
    const swatch = document.createElement('i');
    const count = document.createElement('b');
    box.type = 'checkbox';
    box.name = name;
    box.checked = layer.group.visible = visible;
    box.onchange = () => {
      layer.group.visible = box.checked;
      onSwitch();
    };
    swatch.style.background = colour;
    row.append(box, swatch, label, count);
    document.getElementById('layers').append(row);
    return {count, layer};
  }

  update() {
    for (const {count, layer} of this.rows) {
      const number = layer.triangles === undefined ? layer.count : layer.triangles;
      count.textContent = number >= 1e6 ? `${(number / 1e6).toFixed(2)} M` : number >= 1e4 ? `${Math.round(number / 1e3)} k` : number;
    }
  }
}
