// What is known of the scene apart from how it is drawn: keyframes with their poses, and the graph between them.

export class SceneModel {
  constructor() {
    this.clear();
  }

  clear() {
    this.poses = new Map();      // keyframe → THREE.Matrix4, world from camera
    this.times = new Map();      // keyframe → seconds since the first
    this.blocks = new Map();     // packets "graph"
    this.landmarks = new Map();  // id → {kind, direction, observations, colour}
  }

  takePoses({ids, poses}) {
    ids.forEach((id, i) => {
      const [a, b, c, d, e, f, g, h, k, x, y, z] = poses.subarray(12 * i, 12 * i + 12);
      this.poses.set(id, new THREE.Matrix4().set(a, b, c, x, d, e, f, y, g, h, k, z, 0, 0, 0, 1));
    });
  }

  takeGraph(packet) {
    this.blocks.set(packet.block, packet);
    packet.keyframes.forEach((id, i) => this.times.set(id, packet.times[i]));
  }

  takeLandmarks({ids, kinds, observations, colours, directions}) {
    this.landmarks.clear();
    ids.forEach((id, i) => this.landmarks.set(id, {
      kind: kinds[i], observations: observations[i], colour: colours[i],
      direction: new THREE.Vector3().fromArray(directions, 3 * i),
    }));
  }

  position(keyframe) {
    const pose = this.poses.get(keyframe);
    return pose ? new THREE.Vector3().setFromMatrixPosition(pose) : null;
  }

  /** Calls back with both keyframes and the weight of every edge of a kind: "edges" or "covisibility". */
  forEachEdge(kind, callback) {
    for (const block of this.blocks.values()) {
      const pairs = block[kind];
      for (let i = 0; 2 * i < pairs.length; ++i) callback(pairs[2 * i], pairs[2 * i + 1], block[`${kind}_weights`][i]);
    }
  }

  countEdges(kind) {
    let count = 0;
    for (const block of this.blocks.values()) count += block[kind].length / 2;
    return count;
  }

  /** The landmarks that a keyframe has seen, each once: two walls may have one direction. */
  observationsOf(keyframe) {
    const ids = new Set();
    for (const {observations} of this.blocks.values()) {
      for (let i = 0; i < observations.length; i += 2) {
        if (observations[i] === keyframe && this.landmarks.has(observations[i + 1])) ids.add(observations[i + 1]);
      }
    }
    return [...ids].map((id) => ({id, ...this.landmarks.get(id)}));
  }
}
