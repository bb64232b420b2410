// The platform in three dimensions: live, with the twin as a ghost over it, and pushed by dragging.
import * as THREE from 'three';
import {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import type {Live} from '../live';
import {FALLEN, PAUSED} from '../messages';
import type {Rig} from '../rig';
import {Ahead} from './ahead';
import {Contacts} from './contacts';
import {Drag} from './drag';
import {Effort} from './effort';
import {floorOf} from './floor';
import {type Machine, buildMachine} from './machine';
import {ghostSkin, liveSkin} from './parts';

/** Directions from the middle to the eye. */
const EYES = {corner: [0.72, -0.66, 0.4], behind: [-1, 0, 0.12], side: [0, -1, 0.12], above: [-0.001, 0, 1]} as const;
export type Eye = keyof typeof EYES;
const SLOWED = 0.012;  // of the wheels' speed that is shown: more would flicker

/** Whether a processor has to draw what else a graphics card does. */
function drawnBySoftware(): boolean {
  const gl = document.createElement('canvas').getContext('webgl2');
  const told = gl?.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl?.getParameter(told ? told.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl?.getExtension('WEBGL_lose_context')?.loseContext();
  return /SwiftShader|llvmpipe|softpipe|software|Basic Render/i.test(name);
}

export class Scene {
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
  private readonly orbit: OrbitControls;
  private readonly drag: Drag;
  private machine: Machine | null = null;
  private ghost: Machine | null = null;
  private contacts: Contacts | null = null;
  private ahead: Ahead | null = null;
  private extras: THREE.Object3D[] = [];
  private last = 0;
  private distance = 1;
  private readonly effort: Effort;
  private drawn = 0;  // frames that were due, since the last change of size
  ghostShown = true;

  constructor(private readonly box: HTMLElement, private readonly live: Live) {
    const slow = drawnBySoftware();
    this.effort = new Effort(slow);
    this.renderer = new THREE.WebGLRenderer({antialias: !slow, alpha: true});
    this.renderer.setPixelRatio(Math.min(this.effort.now.pixelRatio, window.devicePixelRatio));
    this.renderer.shadowMap.enabled = this.effort.now.shadows;
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
    this.scene.remove(...this.extras);
    this.machine = buildMachine(rig, liveSkin());
    this.ghost = buildMachine(rig, ghostSkin());
    this.ghost.root.visible = false;
    this.scene.add(this.machine.root, this.ghost.root);
    const {height, reach} = this.machine;
    const size = Math.max(height, 1.6 * reach);
    this.contacts = new Contacts(this.machine);
    this.ahead = new Ahead(this.machine, rig);
    this.extras = [...floorOf(size, reach), this.contacts.object, this.ahead.object];
    this.scene.add(...this.extras);
    this.drag.attach(this.machine, rig);
    const distance = this.distance = 2 * size + 1.3 * reach;
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.orbit.minDistance = 0.5 * distance;
    this.orbit.maxDistance = 3 * distance;
    this.orbit.target.set(0, 0, 0.46 * height);
    this.look('corner');
    this.camera.updateProjectionMatrix();
  }

  /** Where the eye stands. */
  look(from: keyof typeof EYES): void {
    this.camera.position.copy(this.orbit.target).addScaledVector(new THREE.Vector3(...EYES[from]).normalize(), this.distance);
    this.orbit.update();
  }

  draw(now: number): void {
    const {machine, ghost, live} = this;
    const dt = Math.min(0.1, (now - this.last) * 1e-3);
    this.last = now;
    if (machine && live.state) {
      const state = live.state.value;
      const passed = live.stale || live.mode === PAUSED ? 0 : dt * Math.min(1, live.owner?.value.speed_factor || 1);
      machine.pose(state);
      machine.wheels.forEach((wheel, j) => {
        wheel.rotateX(SLOWED * (state.rotor_speed_rad_s[j] ?? 0) * passed);
      });
      this.contacts?.draw(live.age(live.truth) < 1 ? live.truth!.value : null);
      this.ahead?.draw(state, live.age(live.forecast) < 1 && live.mode !== FALLEN ? live.forecast!.value : null);
      const followed = this.ghostShown && live.age(live.twin) < 1;
      ghost!.root.visible = followed;
      if (followed) ghost!.pose(live.twin!.value);
    }
    this.drag.draw();
    this.orbit.update();
    if (this.effort.changed(now)) this.spare();
    if (this.drawn++ % this.effort.now.every === 0) this.renderer.render(this.scene, this.camera);
  }

  /** What a slow machine does without. */
  private spare(): void {
    this.renderer.setPixelRatio(Math.min(this.effort.now.pixelRatio, window.devicePixelRatio));
    this.renderer.shadowMap.enabled = this.effort.now.shadows;
    this.scene.traverse((object) => {
      if (object instanceof THREE.Mesh) for (const material of [object.material].flat()) material.needsUpdate = true;
    });
    this.resize();
  }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.box;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.drawn = 0;  // nothing is left of what was drawn
    this.camera.aspect = width / height;
    // A narrow window sees as much of the width.
    this.camera.fov = width < height ? 44 : 32;
    this.camera.updateProjectionMatrix();
  }
}
