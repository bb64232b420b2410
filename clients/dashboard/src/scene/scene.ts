// The platform in three dimensions: live, with the twin as a ghost over it, and pushed by dragging.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import type {Live} from '../live';
import type {Rig} from '../rig';
import {Drag} from './drag';
import {type Machine, buildMachine} from './machine';
import {ghostSkin, liveSkin} from './parts';

const SLOWED = 0.012;  // of the wheels' speed that is shown: more would flicker

export class Scene {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
  private readonly orbit: OrbitControls;
  private readonly drag: Drag;
  private machine: Machine | null = null;
  private ghost: Machine | null = null;
  private floor: THREE.Object3D[] = [];
  private last = 0;
  private readonly effort = new Effort();
  private drawn = 0;  // frames that were due
  ghostShown = true;

  constructor(private readonly box: HTMLElement, private readonly live: Live) {
    this.renderer = new THREE.WebGLRenderer({antialias: true, alpha: true});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.renderer.toneMapping = THREE.ACESFilmicToneMapping;
    const canvas = this.renderer.domElement;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'The platform in three dimensions');
    box.prepend(canvas);
    this.camera.up.set(0, 0, 1);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enableDamping = true;
    this.orbit.maxPolarAngle = 0.55 * Math.PI;
    this.orbit.enablePan = false;
    this.scene.add(new THREE.HemisphereLight(0xdfe9ff, 0x2a2f3a, 1.25));
    this.drag = new Drag(canvas, this.camera, this.scene, this.orbit, live);
    new ResizeObserver(() => this.resize()).observe(box);
    this.resize();
  }

  build(rig: Rig): void {
    for (const old of [this.machine, this.ghost]) if (old) this.scene.remove(old.root);
    this.scene.remove(...this.floor);
    this.machine = buildMachine(rig, liveSkin());
    this.ghost = buildMachine(rig, ghostSkin());
    this.ghost.root.visible = false;
    this.scene.add(this.machine.root, this.ghost.root);
    const {height, reach} = this.machine;
    const size = Math.max(height, 1.6 * reach);
    this.floor = floorOf(size);
    this.scene.add(...this.floor);
    this.drag.attach(this.machine, rig);
    const middle = new THREE.Vector3(0, 0, 0.46 * height);
    this.orbit.target.copy(middle);
    const distance = 1.9 * size + 1.2 * reach;
    this.camera.position.set(0.72 * distance, -0.66 * distance, middle.z + 0.42 * distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.orbit.minDistance = 0.5 * distance;
    this.orbit.maxDistance = 3 * distance;
  }

  draw(now: number): void {
    const {machine, ghost, live} = this;
    const dt = Math.min(0.1, (now - this.last) * 1e-3);
    this.last = now;
    if (machine && live.state) {
      const state = live.state.value;
      machine.pose(state);
      machine.wheels.forEach((wheel, j) => {
        wheel.rotateX(SLOWED * (state.rotor_speed_rad_s[j] ?? 0) * dt);
      });
      const rest = machine.restForce ?? 1;
      const contacts = live.age(live.truth) < 1 ? live.truth!.value.contact_lower_n : [0, 0, 0, 0];
      machine.light?.(Array.from(contacts, (force) => force / rest));
      const followed = this.ghostShown && live.age(live.twin) < 1;
      ghost!.root.visible = followed;
      if (followed) ghost!.pose(live.twin!.value);
    }
    this.drag.draw();
    this.orbit.update();
    if (this.effort.changed(now)) this.spare();
    if (this.drawn++ % this.effort.every === 0) this.renderer.render(this.scene, this.camera);
  }

  /** What a slow machine does without. */
  private spare(): void {
    this.renderer.setPixelRatio(Math.min(this.effort.pixelRatio, window.devicePixelRatio));
    this.renderer.shadowMap.enabled = this.effort.shadows;
    this.scene.traverse((object) => {
      if (object instanceof THREE.Mesh) for (const material of [object.material].flat()) material.needsUpdate = true;
    });
    this.resize();
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.box;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    // A narrow window sees as much of the width.
    this.camera.fov = width < height ? 44 : 32;
    this.camera.updateProjectionMatrix();
  }
}

/** How much may be drawn so that the page stays quick: less while frames come slowly. */
class Effort {
  private static readonly levels = [
    {pixelRatio: 2, shadows: true, every: 1}, {pixelRatio: 1, shadows: true, every: 1},
    {pixelRatio: 1, shadows: false, every: 2}, {pixelRatio: 0.6, shadows: false, every: 4}];
  private level = 0;
  private since = 0;
  private frames = 0;

  get pixelRatio(): number { return Effort.levels[this.level]!.pixelRatio; }
  get shadows(): boolean { return Effort.levels[this.level]!.shadows; }
  get every(): number { return Effort.levels[this.level]!.every; }

  /** To be asked once a frame. */
  changed(now: number): boolean {
    this.frames += 1;
    if (now - this.since < 1000) return false;
    const rate = 1000 * this.frames / (now - this.since);
    const first = this.since === 0;
    this.since = now;
    this.frames = 0;
    if (first || rate > 24 || this.level === Effort.levels.length - 1) return false;
    this.level += 1;
    return true;
  }
}

/** Ground, its grid, and the sun that throws the shadow. */
function floorOf(size: number): THREE.Object3D[] {
  const ground = new THREE.Mesh(new THREE.CircleGeometry(3.2 * size, 96), new THREE.ShadowMaterial({opacity: 0.28}));
  ground.receiveShadow = true;
  ground.position.z = -0.001 * size;
  const grid = new THREE.PolarGridHelper(2 * size, 12, 6, 96, 0x7d8aa0, 0x7d8aa0);
  grid.rotation.x = Math.PI / 2;
  for (const material of [grid.material].flat()) {
    material.transparent = true;
    material.opacity = 0.22;
  }
  const sun = new THREE.DirectionalLight(0xffffff, 2.4);
  sun.position.set(1.4 * size, -1.1 * size, 3 * size);
  sun.castShadow = true;
  sun.shadow.mapSize.set(1024, 1024);
  const {camera} = sun.shadow;
  camera.left = camera.bottom = -1.6 * size;
  camera.right = camera.top = 1.6 * size;
  camera.near = 0.1 * size;
  camera.far = 8 * size;
  sun.shadow.bias = -0.001;
  sun.shadow.normalBias = 0.012 * size;
  const fill = new THREE.DirectionalLight(0xbfd4ff, 0.7);
  fill.position.set(-2 * size, size, size);
  return [ground, grid, sun, fill];
}
