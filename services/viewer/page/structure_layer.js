import {colour} from './palette.js';

// The sparse map: points, lines by direction, planes. Points and lines hang on their keyframes.

const kPointColour = 0xd5dfeb;
const kLineOpacity = 0.3;  // of what one keyframe saw: lines that many saw are bright, and single mistakes are faint

/** One object per keyframe, moved by the keyframe's pose. */
class OnKeyframes {
  constructor(view, model) {
    this.model = model;
    this.group = new THREE.Group();
    this.objects = new Map();
    this.count = 0;
    view.world.add(this.group);
  }

  clear() {
    for (const id of [...this.objects.keys()]) this.remove(id);
  }

  remove(keyframe) {
    const object = this.objects.get(keyframe);
    if (!object) return;
    this.group.remove(object);
    object.geometry.dispose();
    this.count -= object.userData.count;
    this.objects.delete(keyframe);
  }

  put(keyframe, object, count) {
    this.remove(keyframe);
    object.matrixAutoUpdate = false;
    object.userData.count = count;
    this.objects.set(keyframe, object);
    this.group.add(object);
    this.count += count;
    this.place(keyframe);
  }

  place(keyframe) {
    const pose = this.model.poses.get(keyframe);
    const object = this.objects.get(keyframe);
    object.visible = Boolean(pose);
    if (!pose) return;
    object.matrix.copy(pose);
    object.matrixWorldNeedsUpdate = true;
  }

  update() {
    for (const keyframe of this.objects.keys()) this.place(keyframe);
  }
}

export class PointLayer extends OnKeyframes {
  constructor(view, model) {
    super(view, model);
    this.material = new THREE.PointsMaterial({color: kPointColour, size: 1.6, sizeAttenuation: false});
  }

  take({keyframe, points}) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
    this.put(keyframe, new THREE.Points(geometry, this.material), points.length / 3);
  }
}

export class LineLayer extends OnKeyframes {
  constructor(view, model) {
    super(view, model);
    this.material = new THREE.LineBasicMaterial(
        {vertexColors: THREE.VertexColors, transparent: true, opacity: kLineOpacity, depthWrite: false});
  }

  take({keyframe, lines, line_colours: numbers}) {
    const colours = new Float32Array(lines.length);
    numbers.forEach((number, i) => {
      colour(number).toArray(colours, 6 * i);
      colour(number).toArray(colours, 6 * i + 3);
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(lines, 3));
    geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
    this.put(keyframe, new THREE.LineSegments(geometry, this.material), numbers.length);
  }
}

/** Translucent hulls with an outline and a normal. */
export class PlaneLayer {
  constructor(view) {
    this.group = new THREE.Group();
    this.count = 0;
    view.world.add(this.group);
  }

  clear() {
    for (const object of [...this.group.children]) {
      this.group.remove(object);
      object.traverse((part) => part.geometry && part.geometry.dispose());
    }
    this.count = 0;
  }

  take({sizes, colours, corners, normals}) {
    this.clear();
    let first = 0;
    sizes.forEach((size, i) => {
      const points = [];
      for (let k = first; k < first + size; ++k) points.push(new THREE.Vector3().fromArray(corners, 3 * k));
      this.group.add(this.plane(points, new THREE.Vector3().fromArray(normals, 3 * i), colour(colours[i])));
      first += size;
    });
    this.count = sizes.length;
  }

  plane(points, normal, paint) {
    const fan = [];
    for (let i = 1; i + 1 < points.length; ++i) fan.push(points[0], points[i], points[i + 1]);
    const fill = new THREE.Mesh(
        new THREE.BufferGeometry().setFromPoints(fan),
        new THREE.MeshBasicMaterial(
            {color: paint, transparent: true, opacity: 0.16, side: THREE.DoubleSide, depthWrite: false}));
    const outline = new THREE.LineLoop(
        new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({color: paint}));
    const centre = points.reduce((sum, point) => sum.add(point), new THREE.Vector3()).divideScalar(points.length);
    const object = new THREE.Group();
    object.add(fill, outline, new THREE.ArrowHelper(normal, centre, 0.3, paint.getHex(), 0.08, 0.05));
    return object;
  }
}
