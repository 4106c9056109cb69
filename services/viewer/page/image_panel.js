import {cssColour} from './palette.js';

// The image as the system sees it: points, lines by direction, planes tinted; and the depth image.

async function toBitmap(bytes) {
  return createImageBitmap(new Blob([bytes]));
}

export class ImagePanel {
  /** @param onImage is given every new colour image */
  constructor(onImage) {
    this.colour = document.getElementById('colour');
    this.depth = document.getElementById('depth');
    this.legend = document.getElementById('features');
    this.frame = document.getElementById('frame');
    this.onImage = onImage;
    this.shown = -1;
  }

  clear() {
    this.shown = -1;
  }

  async take(packet) {
    this.sequence = packet.sequence;
    try {
      const colour = packet.colour && await toBitmap(packet.colour);
      const depth = packet.depth && await toBitmap(packet.depth);
      if (packet.sequence !== this.sequence) return;  // overtaken by a newer one
      this.draw(packet, colour, depth);
    } catch (error) {
      console.warn(`frame ${packet.sequence} cannot be shown: ${error.message}`);
    }
  }

  draw(packet, colour, depth) {
    const context = this.colour.getContext('2d');
    this.colour.width = packet.width || this.colour.width;
    this.colour.height = packet.height || this.colour.height;
    this.colour.style.aspectRatio = `${this.colour.width} / ${this.colour.height}`;
    if (colour) {
      context.drawImage(colour, 0, 0);
      this.onImage(colour);
    }
    if (packet.points) this.drawFeatures(context, packet);
    if (depth) {
      this.depth.width = depth.width;
      this.depth.height = depth.height;
      this.depth.getContext('2d').drawImage(depth, 0, 0);
    }
    this.frame.textContent = `frame ${packet.sequence}`;
    this.shown = packet.sequence;
  }

  drawFeatures(context, packet) {
    this.drawPlanes(context, packet);
    context.lineWidth = 2;
    for (let i = 0; 4 * i < packet.lines.length; ++i) {
      const [x0, y0, x1, y1] = packet.lines.subarray(4 * i, 4 * i + 4);
      context.strokeStyle = cssColour(packet.line_colours[i]);
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
    }
    for (let i = 0; 2 * i < packet.points.length; ++i) {
      context.fillStyle = packet.point_has_depth[i] ? 'rgba(255, 255, 255, 0.85)' : 'rgba(255, 93, 93, 0.85)';
      context.fillRect(packet.points[2 * i] - 1, packet.points[2 * i + 1] - 1, 3, 3);
    }
    this.legend.innerHTML = '';
    const counts = {points: packet.points.length / 2, lines: packet.lines.length / 4, planes: packet.plane_sizes.length};
    for (const [name, count] of Object.entries(counts)) {
      const row = document.createElement('div');
      row.innerHTML = `<span>${name}</span><b>${count}</b>`;
      this.legend.append(row);
    }
  }

  drawPlanes(context, packet) {
    let first = 0;
    packet.plane_sizes.forEach((size, i) => {
      context.beginPath();
      for (let k = first; k < first + size; ++k) {
        context.lineTo(packet.plane_corners[2 * k], packet.plane_corners[2 * k + 1]);
      }
      context.closePath();
      context.fillStyle = cssColour(packet.plane_colours[i]);
      context.globalAlpha = 0.28;
      context.fill();
      context.globalAlpha = 1;
      first += size;
    });
  }
}
