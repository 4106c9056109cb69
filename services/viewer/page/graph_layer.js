import {kLayerColours, colour} from './palette.js';

// Keyframes and the edges between them, as in the paper's figures: covisibility red, E-Graph green.

const kFrustum = 0.09;  // metres
const kPickRadius = 14;  // pixels

function lineObject(cssColour, opacity) {
  const material = new THREE.LineBasicMaterial({color: cssColour, transparent: opacity < 1, opacity, depthWrite: opacity === 1});
  const object = new THREE.LineSegments(new THREE.BufferGeometry(), material);
  object.frustumCulled = false;
  return object;
}

function setPoints(object, numbers) {
  object.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(numbers), 3));
}

/** The edges of a view pyramid of this size in its camera's frame, as pairs of points. */
export function frustumLines(size) {
  const w = 0.66 * size, h = 0.5 * size, d = size;
  const corners = [[-w, -h, d], [w, -h, d], [w, h, d], [-w, h, d]];
  const lines = [];
  corners.forEach((corner, i) => lines.push([0, 0, 0], corner, corner, corners[(i + 1) % 4]));
  return lines.map((point) => new THREE.Vector3(...point));
}

export class KeyframeLayer {
  constructor(view, model) {
    this.view = view;
    this.model = model;
    this.lines = frustumLines(kFrustum);
    this.group = lineObject(kLayerColours.keyframes, 1);
    view.world.add(this.group);
  }

  get count() {
    return this.model.poses.size;
  }

  update() {
    const numbers = [];
    const point = new THREE.Vector3();
    for (const pose of this.model.poses.values()) {
      for (const corner of this.lines) {
        point.copy(corner).applyMatrix4(pose);
        numbers.push(point.x, point.y, point.z);
      }
    }
    setPoints(this.group, numbers);
  }

  /** Where on the screen a keyframe is: x y in pixels, or null behind the view. */
  pixel(id) {
    const {clientWidth: width, clientHeight: height} = this.view.canvas;
    const point = this.model.position(id).applyMatrix4(this.view.world.matrix).project(this.view.camera);
    return point.z > 1 ? null : [(point.x + 1) / 2 * width, (1 - point.y) / 2 * height];
  }

  /** The keyframe nearest to a pixel of the view, or null. */
  pick(x, y) {
    let nearest = null;
    let best = kPickRadius;
    for (const id of this.model.poses.keys()) {
      const pixel = this.pixel(id);
      if (!pixel) continue;
      const distance = Math.hypot(pixel[0] - x, pixel[1] - y);
      if (distance >= best) continue;
      best = distance;
      nearest = id;
    }
    return nearest;
  }
}

export class EdgeLayer {
  /** @param kind "edges" or "covisibility" */
  constructor(view, model, kind, cssColour) {
    this.model = model;
    this.kind = kind;
    this.group = lineObject(cssColour, 0.5);
    view.world.add(this.group);
    this.count = 0;
  }

  update() {
    const numbers = [];
    this.count = 0;
    this.model.forEachEdge(this.kind, (first, second) => {
      const a = this.model.position(first), b = this.model.position(second);
      if (!a || !b) return;
      numbers.push(a.x, a.y, a.z, b.x, b.y, b.z);
      ++this.count;
    });
    setPoints(this.group, numbers);
    // Many thousand edges would hide the scene: the more there are, the fainter each.
    this.group.material.opacity = Math.max(0.05, Math.min(0.7, 6 / Math.sqrt(this.count + 1)));
  }
}

/** The selected keyframe: its view pyramid, its edges and its directions. */
export class SelectionLayer {
  constructor(view, model) {
    this.view = view;
    this.model = model;
    this.selected = null;
    this.group = new THREE.Group();
    this.edges = lineObject('#ffffff', 1);
    this.frustum = lineObject('#ffffff', 1);
    this.arrows = new THREE.Group();
    this.group.add(this.edges, this.frustum, this.arrows);
    view.world.add(this.group);
  }

  select(keyframe) {
    this.selected = keyframe;
    this.update();
    this.view.invalidate();
  }

  update() {
    const pose = this.model.poses.get(this.selected);
    this.group.visible = Boolean(pose);
    this.arrows.remove(...this.arrows.children);
    if (!pose) return;
    const numbers = [];
    this.model.forEachEdge('edges', (first, second) => {
      if (first !== this.selected && second !== this.selected) return;
      const a = this.model.position(first), b = this.model.position(second);
      if (a && b) numbers.push(...a.toArray(), ...b.toArray());
    });
    setPoints(this.edges, numbers);
    setPoints(this.frustum, frustumLines(2 * kFrustum).flatMap((corner) => corner.applyMatrix4(pose).toArray()));
    const position = this.model.position(this.selected);
    for (const landmark of this.model.observationsOf(this.selected)) {
      this.arrows.add(new THREE.ArrowHelper(landmark.direction, position, 0.4, colour(landmark.colour).getHex(), 0.08, 0.05));
    }
  }
}
