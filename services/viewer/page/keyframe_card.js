import {cssColour} from './palette.js';

// What is known of the keyframe that was clicked on: its image, its directions, its edges.

const kKinds = ['plane normal', 'vanishing direction', 'single line'];

export class KeyframeCard {
  /** @param onClose is called when the user closes the card */
  constructor(model, onClose) {
    this.model = model;
    this.card = document.getElementById('keyframe');
    this.image = document.getElementById('keyframe-image');
    this.image.onerror = () => { this.image.hidden = true; };
    document.getElementById('keyframe-close').onclick = (event) => {
      event.preventDefault();
      onClose();
    };
  }

  show(keyframe) {
    this.card.hidden = keyframe === null;
    if (keyframe === null) return;
    document.getElementById('keyframe-id').textContent = keyframe;
    this.image.hidden = false;
    this.image.src = `keyframe/${keyframe}.jpg`;
    const count = (kind) => {
      let edges = 0;
      this.model.forEachEdge(kind, (first, second) => { edges += first === keyframe || second === keyframe ? 1 : 0; });
      return edges;
    };
    const time = this.model.times.get(keyframe);
    document.getElementById('keyframe-text').textContent =
        (time === undefined ? '' : `${time.toFixed(2)} s · `) +
        `${count('edges')} E-Graph edges · ${count('covisibility')} covisible`;
    this.showDirections(this.model.observationsOf(keyframe));
  }

  showDirections(landmarks) {
    const list = document.getElementById('keyframe-directions');
    list.innerHTML = '';
    for (const landmark of landmarks) {
      const item = document.createElement('li');
      const dot = document.createElement('i');
      dot.style.background = cssColour(landmark.colour);
      item.append(dot, `${kKinds[landmark.kind]}, seen ${landmark.observations}×`);
      list.append(item);
    }
  }
}
