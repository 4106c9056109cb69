import {kLayerColours} from './palette.js';

// A grid on the lowest level of the scene, for size and level: a square is a metre, ten of them in large scenes.

const kCells = [1, 10];      // metres
const kMostCells = 40;       // along a side, of the smaller ones
const kBelow = 0.02;         // metres

export class GridLayer {
  constructor(view) {
    this.group = new THREE.Group();
    this.count = '';
    this.shown = '';
    view.scene.add(this.group);
  }

  /** @param bounds of the scene as it is seen, y up */
  update(bounds) {
    if (bounds.isEmpty()) return;
    const size = bounds.getSize(new THREE.Vector3());
    const extent = Math.max(size.x, size.z);
    const cell = extent / kCells[0] <= kMostCells ? kCells[0] : kCells[1];
    const cells = 2 * Math.ceil(extent / cell / 2) + 2;
    const centre = bounds.getCenter(new THREE.Vector3()).divideScalar(cell).round().multiplyScalar(cell);
    centre.y = bounds.min.y - kBelow;
    const wanted = [cell, cells, ...centre.toArray()].join();
    if (wanted === this.shown) return;
    this.shown = wanted;
    this.count = `${cell} m`;
    for (const old of [...this.group.children]) {
      this.group.remove(old);
      old.geometry.dispose();
    }
    const colour = new THREE.Color(kLayerColours.grid);
    const grid = new THREE.GridHelper(cells * cell, cells, colour, colour);
    grid.position.copy(centre);
    grid.material.transparent = true;
    grid.material.opacity = 0.5;
    this.group.add(grid);
  }
}
