// A coarser set of triangles over the same vertices: those that fall into one cell of a grid become one
// (Rossignac, Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993). No vertex is copied.

/**
 * @param positions 16-bit numbers, four per vertex, of which the first three are x y z
 * @param indices of all triangles
 * @param cells how many cells along each axis, over the whole range of the numbers
 * @return indices of the triangles whose corners lie in three different cells
 */
export function simplify(positions, indices, cells) {
  const representatives = new Int32Array(cells ** 3).fill(-1);
  const count = positions.length / 4;
  const replaced = new Uint32Array(count);
  for (let i = 0; i < count; ++i) {
    const x = (positions[4 * i] * cells) >> 16;
    const y = (positions[4 * i + 1] * cells) >> 16;
    const z = (positions[4 * i + 2] * cells) >> 16;
    const cell = (z * cells + y) * cells + x;
    if (representatives[cell] < 0) representatives[cell] = i;
    replaced[i] = representatives[cell];
  }
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
