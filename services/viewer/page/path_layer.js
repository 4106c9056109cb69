import {kLayerColours} from './palette.js';

// Trajectories: the estimate, which hangs on its keyframes, and the true one.

/** A line with dots on it: lines alone are one pixel wide. */
class DottedPath {
  constructor(cssColour) {
    const colour = new THREE.Color(cssColour);
    this.object = new THREE.Group();
    this.geometry = new THREE.BufferGeometry();
    this.lines = new THREE.LineSegments(this.geometry, new THREE.LineBasicMaterial({color: colour}));
    this.dotGeometry = new THREE.BufferGeometry();
    this.dots = new THREE.Points(
        this.dotGeometry, new THREE.PointsMaterial({color: colour, size: 3, sizeAttenuation: false}));
    this.lines.frustumCulled = this.dots.frustumCulled = false;
    this.object.add(this.lines, this.dots);
  }

  /** @param joined whether the point is joined to the one before it */
  set(points, joined) {
    const segments = [];
    for (let i = 1; 3 * i < points.length; ++i) {
      if (joined(i)) segments.push(...points.slice(3 * i - 3, 3 * i + 3));
    }
    this.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(segments), 3));
    this.dotGeometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(points), 3));
  }
}

export class TrajectoryLayer {
  constructor(view, model) {
    this.model = model;
    this.path = new DottedPath(kLayerColours.trajectory);
    this.group = this.path.object;
    view.world.add(this.group);
    this.clear();
  }

  clear() {
    this.blocks = [];
    this.count = 0;
    this.path.set([], () => false);
  }

  take(packet) {
    this.blocks[packet.block] = packet;
  }

  update() {
    const points = [];
    const follows = [];
    const point = new THREE.Vector3();
    for (const block of this.blocks) {
      if (!block) continue;
      block.keyframes.forEach((keyframe, i) => {
        const pose = this.model.poses.get(keyframe);
        if (!pose) return;
        point.fromArray(block.positions, 3 * i).applyMatrix4(pose);
        points.push(point.x, point.y, point.z);
        follows.push(block.follows[i]);
      });
    }
    this.count = follows.length;
    this.path.set(points, (i) => follows[i]);
    this.points = points;
  }

  bounds(box) {
    for (let i = 0; i < 3 * this.count; i += 3) box.expandByPoint(new THREE.Vector3().fromArray(this.points, i));
  }
}

export class TruthLayer {
  constructor(view) {
    this.path = new DottedPath(kLayerColours.truth);
    this.group = this.path.object;
    view.world.add(this.group);
    this.clear();
  }

  clear() {
    this.take({positions: new Float32Array(0)});
  }

  take({positions}) {
    this.count = positions.length / 3;
    this.path.set([...positions], () => true);
  }
}
