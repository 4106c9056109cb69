import {frustumLines} from './graph_layer.js';
import {kLayerColours} from './palette.js';

// The camera where it is now: its view pyramid with the live image in it.

const kSize = 0.3;  // metres

export class CameraLayer {
  constructor(view) {
    this.group = new THREE.Group();
    this.group.matrixAutoUpdate = false;
    this.group.visible = false;
    this.texture = new THREE.CanvasTexture(document.createElement('canvas'));
    this.texture.minFilter = THREE.LinearFilter;
    const lines = new THREE.BufferGeometry().setFromPoints(frustumLines(kSize));
    this.frustum = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({color: kLayerColours.trajectory}));
    this.picture = new THREE.Mesh(
        this.rectangle(), new THREE.MeshBasicMaterial({map: this.texture, side: THREE.DoubleSide}));
    this.picture.visible = false;
    this.group.add(this.frustum, this.picture);
    view.world.add(this.group);
  }

  rectangle() {
    const w = 0.66 * kSize, h = 0.5 * kSize;
    const corners = [[-w, -h], [w, -h], [w, h], [-w, h]].map(([x, y]) => new THREE.Vector3(x, y, kSize));
    const geometry = new THREE.BufferGeometry().setFromPoints(corners);
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    // The image's first row is where the camera frame's y is smallest, or, with a negative fy, largest.
    geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array([0, 1, 1, 1, 1, 0, 0, 0]), 2));
    return geometry;
  }

  clear() {
    this.group.visible = false;
    this.picture.visible = false;
  }

  setPose(pose, mirrored) {
    this.group.visible = true;
    this.group.matrix.copy(pose);
    this.group.matrixWorldNeedsUpdate = true;
    this.picture.scale.y = mirrored ? -1 : 1;
  }

  setImage(image) {
    this.texture.image = image;
    this.texture.needsUpdate = true;
    this.picture.visible = true;
  }
}
