// Pushing by dragging: what is pulled and let go gets a push in that direction, the further the harder.
import * as THREE from 'three';
import type {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import type {Live} from '../live';
import {impulse} from '../requests';
import type {Rig} from '../rig';
import type {Machine} from './machine';

const FULL = 0.3;   // of the view's height for twice the reference push
const LEAST = 0.02;  // shorter is a slip

export class Drag {
  private machine: Machine | null = null;
  private rig: Rig | null = null;
  private readonly arrow = new THREE.ArrowHelper(new THREE.Vector3(1, 0, 0), new THREE.Vector3(), 1, 0xff7a45);
  private readonly ray = new THREE.Raycaster();
  private start: {x: number; y: number; pointer: number} | null = null;
  private pull = new THREE.Vector3();  // world, horizontal; length 1: the reference push

  constructor(private readonly canvas: HTMLCanvasElement, private readonly camera: THREE.PerspectiveCamera,
    scene: THREE.Scene, private readonly orbit: OrbitControls, private readonly live: Live) {
    this.arrow.visible = false;
    scene.add(this.arrow);
    canvas.addEventListener('pointerdown', (event) => this.press(event), {capture: true});
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.release(event));
    canvas.addEventListener('pointercancel', () => this.cancel());
    window.addEventListener('keydown', (event) => { if (event.key === 'Escape') this.cancel(); });
  }

  attach(machine: Machine, rig: Rig): void {
    this.machine = machine;
    this.rig = rig;
  }

  private hits(event: PointerEvent): boolean {
    if (!this.machine || !this.rig?.tilts) return false;
    const {left, top, width, height} = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(2 * (event.clientX - left) / width - 1, 1 - 2 * (event.clientY - top) / height);
    this.ray.setFromCamera(at, this.camera);
    return this.ray.intersectObject(this.machine.root, true).length > 0;
  }

  private press(event: PointerEvent): void {
    if (!this.live.isOperator || event.button !== 0 || !this.hits(event)) return;
    this.start = {x: event.clientX, y: event.clientY, pointer: event.pointerId};
    this.canvas.setPointerCapture(event.pointerId);
    this.orbit.enabled = false;
    event.stopImmediatePropagation();
  }

  private move(event: PointerEvent): void {
    if (!this.start) {
      if (event.pointerType === 'mouse') this.canvas.style.cursor = this.live.isOperator && this.hits(event) ? 'grab' : '';
      return;
    }
    const scale = 2 / (FULL * this.canvas.clientHeight);
    const right = scale * (event.clientX - this.start.x), up = scale * (this.start.y - event.clientY);
    // Along the ground as it is seen: sideways, and away from the eye.
    const sideways = new THREE.Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion).setZ(0).normalize();
    const away = new THREE.Vector3(-sideways.y, sideways.x, 0);
    this.pull.set(0, 0, 0).addScaledVector(sideways, right).addScaledVector(away, up);
    if (!this.rig!.tiltsTwoWays) this.pull.x = 0;  // it stands on a line along x
    if (this.pull.length() > 2) this.pull.setLength(2);
  }

  private release(event: PointerEvent): void {
    if (!this.start) return;
    const moved = Math.hypot(event.clientX - this.start.x, event.clientY - this.start.y);
    const pull = this.pull.clone();
    this.cancel();
    if (moved < LEAST * this.canvas.clientHeight || pull.length() < LEAST) return;
    // Towards y is a moment about -x; towards x about y.
    const J = this.rig!.impulse;
    this.live.ask(impulse(this.rig!, -J * pull.y, J * pull.x), `push of ${(J * pull.length()).toPrecision(2)} N m s`);
  }

  private cancel(): void {
    if (this.start && this.canvas.hasPointerCapture(this.start.pointer)) this.canvas.releasePointerCapture(this.start.pointer);
    this.start = null;
    this.orbit.enabled = true;
    this.pull.set(0, 0, 0);
  }

  draw(): void {
    const length = this.pull.length();
    this.arrow.visible = this.start !== null && length > LEAST;
    if (!this.arrow.visible || !this.machine) return;
    const at = new THREE.Vector3(0, 0, 0.8 * this.machine.height).applyMatrix4(this.machine.structure.matrixWorld);
    const size = length * this.machine.reach;
    this.arrow.position.copy(at);
    this.arrow.setDirection(this.pull.clone().normalize());
    this.arrow.setLength(size, Math.min(0.3 * size, 0.2 * this.machine.reach), 0.1 * this.machine.reach);
  }
}
