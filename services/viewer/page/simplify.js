// A coarser set of triangles over the same vertices: those that fall into one cell of a grid become one
// (Rossignac, Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993). No vertex is copied.

const kRankOfAxis = [1, 0.618, 0.764];  // orders a cell's vertices so that no two are equal

/**
 * The grid is the tile's own, and the vertices on the tile's faces, which it has in common with its neighbours, are
 * replaced among themselves, the same ones in both tiles: no gaps open between tiles of one level.
 *
 * @param positions 16-bit numbers, four per vertex, of which the first three are x y z
 * @param indices of all triangles
 * @param low where 0 0 0 lies in the tile, metres from its lowest corner
 * @param step what one of the numbers stands for, metres
 * @param edge of the tile, metres
 * @param cells how many cells along each axis of the tile
 * @return indices of the triangles whose corners lie in three different cells
 */
export function simplify({positions, indices, low, step, edge}, cells) {
  const inside = new Int32Array(cells ** 3).fill(-1);  // cell → the vertex that stands for all in it
  const onFaces = new Map();                           // the same for vertices on a face, by cell and face
  const count = positions.length / 4;
  const keys = new Int32Array(count);
  for (let i = 0; i < count; ++i) {
    let cell = 0, face = 0, rank = 0;
    for (let axis = 0; axis < 3; ++axis) {
      const at = low[axis] + step * positions[4 * i + axis];
      cell = cell * cells + Math.max(0, Math.min(cells - 1, Math.floor(at / edge * cells)));
      face = face * 3 + (at < 2 * step ? 1 : at > edge - 2 * step ? 2 : 0);
      rank += kRankOfAxis[axis] * at;
    }
    if (face === 0) {
      keys[i] = cell;
      if (inside[cell] < 0) inside[cell] = i;
      continue;
    }
    const key = cell * 27 + face;
    const first = onFaces.get(key);
    keys[i] = -1 - key;
    if (!first || rank < first.rank) onFaces.set(key, {vertex: i, rank});
  }
  const replaced = keys.map((key) => (key < 0 ? onFaces.get(-1 - key).vertex : inside[key]));
  const kept = new indices.constructor(indices.length);
  let size = 0;
  for (let i = 0; i < indices.length; i += 3) {
    const a = replaced[indices[i]], b = replaced[indices[i + 1]], c = replaced[indices[i + 2]];
    if (a === b || b === c || c === a) continue;
    kept[size] = a;
    kept[size + 1] = b;
    kept[size + 2] = c;
    size += 3;
  }
  return kept.slice(0, size);
}
