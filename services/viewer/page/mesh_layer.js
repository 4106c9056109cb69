import {simplify} from './simplify.js';

// The mesh, tile by tile. Each tile has its triangles in three levels of detail; a tile out of sight costs nothing, and one
// that is far away or that the machine cannot draw in time is drawn coarsely while the view moves.

const kCells = [0.04, 0.1];     // metres: sizes of the cells that the coarser levels are made of
const kMostCells = 64;          // along an edge of a tile
const kLargest = 65535;         // of the numbers that positions are sent as
const kFinestPixels = 1.5;      // a cell smaller than this on the screen may be drawn as one point
const kCoarsestPixels = 40;
const kGoodFrame = 20;          // ms
const kBadFrame = 33;
const kSimplifyingTime = 6;     // ms per frame for making coarser levels

export class MeshLayer {
  constructor(view) {
    this.view = view;
    this.group = new THREE.Group();
    // A little behind where it is, so that planes and lines in the surface are seen.
    this.material = new THREE.MeshLambertMaterial(
        {vertexColors: THREE.VertexColors, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4});
    this.tiles = new Map();
    this.waiting = [];  // tiles without their coarser levels
    this.triangles = 0;
    this.detail = kFinestPixels;
    this.lastFrame = 0;
    this.wasMoving = false;
    view.world.add(this.group);
    view.beforeDrawing.push(() => this.chooseLevels());
  }

  clear() {
    for (const key of [...this.tiles.keys()]) this.remove(key);
    this.waiting = [];
  }

  remove(key) {
    const tile = this.tiles.get(key);
    if (!tile) return;
    this.group.remove(tile.mesh);
    tile.levels.forEach((geometry) => geometry.dispose());
    this.triangles -= tile.indices.length / 3;
    this.tiles.delete(key);
  }

  take(packet) {
    const key = packet.tile.join();
    this.remove(key);
    if (packet.indices.length > 0) this.add(key, packet);
    this.view.invalidate();
  }

  add(key, {positions, normals, colours, indices, bounds, tile: number, edge}) {
    const low = new THREE.Vector3().fromArray(bounds);
    const size = new THREE.Vector3().fromArray(bounds, 3).sub(low);
    const scale = Math.max(size.x, size.y, size.z, 1e-6);  // what the numbers from 0 to 1 are multiplied with
    const half = size.clone().divideScalar(2 * scale);
    const tile = {
      positions, indices, size, scale, edge,
      low: low.toArray().map((x, axis) => x - number[axis] * edge),
      step: scale / kLargest,
      attributes: {
        position: new THREE.BufferAttribute(positions, 4, true),
        normal: new THREE.BufferAttribute(normals, 4, true),
        color: new THREE.BufferAttribute(colours, 4, true),
      },
      sphere: new THREE.Sphere(half, half.length()),
      centre: low.clone().addScaledVector(size, 0.5),
      levels: [],
    };
    tile.levels.push(this.geometry(tile, indices));
    tile.mesh = new THREE.Mesh(tile.levels[0], this.material);
    tile.mesh.position.copy(low);
    tile.mesh.scale.setScalar(scale);
    this.tiles.set(key, tile);
    this.group.add(tile.mesh);
    this.triangles += indices.length / 3;
    this.waiting.push(tile);
  }

  geometry({attributes, sphere}, indices) {
    const geometry = new THREE.BufferGeometry();
    for (const name of Object.keys(attributes)) geometry.setAttribute(name, attributes[name]);
    geometry.setIndex(new THREE.BufferAttribute(indices, 1));
    geometry.boundingSphere = sphere;
    return geometry;
  }

  /** Makes coarser levels of some tiles that have none. */
  simplifySome() {
    const end = performance.now() + kSimplifyingTime;
    while (this.waiting.length > 0 && performance.now() < end) {
      const tile = this.waiting.shift();
      if (!tile.mesh.parent) continue;
      for (const cell of kCells) {
        const cells = Math.max(1, Math.min(kMostCells, Math.ceil(tile.edge / cell)));
        tile.levels.push(this.geometry(tile, simplify(tile, cells)));
      }
    }
    if (this.waiting.length > 0) this.view.invalidate();
  }

  chooseLevels() {
    this.simplifySome();
    this.adaptDetail();
    const eye = this.view.camera.position.clone().applyMatrix4(new THREE.Matrix4().getInverse(this.view.world.matrix));
    const pixels = this.view.pixelsPerRadian();
    // At rest a frame may take longer, but not so long that a slow machine stands still.
    const limit = this.view.isMoving() ? this.detail : Math.max(kFinestPixels, this.detail / 4);
    for (const tile of this.tiles.values()) {
      const distance = Math.max(0.1, eye.distanceTo(tile.centre) - tile.size.length() / 2);
      let level = 0;
      while (level + 1 < tile.levels.length && kCells[level] / distance * pixels < limit) ++level;
      tile.mesh.geometry = tile.levels[level];
    }
  }

  /** While the view moves: less detail at once if frames come too slowly, slowly more if there is time. */
  adaptDetail() {
    const now = performance.now();
    const frame = now - this.lastFrame;
    const moving = this.view.isMoving();
    const counts = moving && this.wasMoving;  // else the time is a pause
    this.lastFrame = now;
    this.wasMoving = moving;
    if (!counts) return;
    if (frame > kBadFrame) this.detail = Math.min(kCoarsestPixels, this.detail * Math.min(4, frame / kBadFrame));
    if (frame < kGoodFrame) this.detail = Math.max(kFinestPixels, this.detail / 1.05);
  }

  bounds(box) {
    for (const tile of this.tiles.values()) {
      box.expandByPoint(tile.mesh.position);
      box.expandByPoint(tile.mesh.position.clone().add(tile.size));
    }
  }
}
