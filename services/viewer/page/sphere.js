import {colour} from './palette.js';

// The directions of the E-Graph on a unit sphere, seen from where the scene is seen from.

const kPlaneNormal = 0;
const kPotentialDirection = 2;
const kWellKnown = 20;  // observations

export class DirectionSphere {
  constructor(view) {
    this.view = view;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(42, 1, 0.1, 10);
    this.world = new THREE.Group();
    this.world.matrixAutoUpdate = false;
    this.world.matrix = view.world.matrix;
    const ball = new THREE.Mesh(
        new THREE.SphereBufferGeometry(1, 24, 16),
        new THREE.MeshBasicMaterial({color: 0x6b7c91, wireframe: true, transparent: true, opacity: 0.14}));
    this.rays = new THREE.Group();
    this.world.add(this.rays);
    this.scene.add(ball, this.world);
    this.marker = new THREE.SphereBufferGeometry(1, 12, 8);
    view.inset = {scene: this.scene, camera: this.camera};
  }

  update(landmarks) {
    for (const ray of [...this.rays.children]) {
      this.rays.remove(ray);
      ray.children[0].geometry.dispose();
    }
    for (const landmark of landmarks.values()) this.rays.add(this.ray(landmark));
    this.world.matrixWorldNeedsUpdate = true;
    this.view.invalidate();
  }

  /** Planes point one way; lines have no sign and are drawn both ways. */
  ray({kind, direction, observations, colour: number}) {
    const paint = colour(number);
    const trust = Math.min(1, observations / kWellKnown);
    const start = kind === kPlaneNormal ? new THREE.Vector3() : direction.clone().negate();
    const line = new THREE.Line(
        new THREE.BufferGeometry().setFromPoints([start, direction]),
        new THREE.LineBasicMaterial({color: paint, transparent: true, opacity: kind === kPotentialDirection ? 0 : trust}));
    const tip = new THREE.Mesh(this.marker, new THREE.MeshBasicMaterial({color: paint}));
    tip.position.copy(direction);
    tip.scale.setScalar((kind === kPlaneNormal ? 0.07 : 0.045) * (0.3 + 0.7 * trust));
    const ray = new THREE.Group();
    ray.add(line, tip);
    return ray;
  }
}
