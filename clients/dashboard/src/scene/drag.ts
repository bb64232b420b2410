// Pushing by dragging: what is pulled and let go gets a push in that direction, the further the harder.
import * as THREE from 'three';
import type {OrbitControls} from 'three/examples/jsm/controls/OrbitControls.js';

import {el, say} from '../dom';
import type {Live} from '../live';
import {RUNNING, SAFE_STOP} from '../messages';
import {impulse} from '../requests';
import type {Rig} from '../rig';
import {amount} from '../units';
import type {Machine} from './machine';
import {Arrow} from './parts';

const FULL = 0.3;    // of the view's height for twice the reference push
const MOST = 2;      // reference pushes
const LEAST = 0.02;  // shorter is a slip

export class Drag {
  private machine: Machine | null = null;
  private rig: Rig | null = null;
  private arrow: Arrow | null = null;
  private readonly words = el('div', {class: 'pull', hidden: true});
  private readonly ray = new THREE.Raycaster();
  private start: {x: number; y: number; pointer: number} | null = null;
  private readonly grip = new THREE.Vector3();  // where it is held, in the structure's frame
  private readonly pull = new THREE.Vector3();  // world, horizontal; length 1: the reference push

  constructor(private readonly canvas: HTMLCanvasElement, private readonly camera: THREE.PerspectiveCamera,
    private readonly scene: THREE.Scene, private readonly orbit: OrbitControls, private readonly live: Live) {
    canvas.after(this.words);
    canvas.addEventListener('pointerdown', (event) => this.press(event), {capture: true});
    canvas.addEventListener('pointermove', (event) => this.move(event));
    canvas.addEventListener('pointerup', (event) => this.release(event));
    canvas.addEventListener('pointercancel', () => this.cancel());
    window.addEventListener('keydown', (event) => { if (event.key === 'Escape') this.cancel(); });
  }

  attach(machine: Machine, rig: Rig): void {
    if (this.arrow) this.scene.remove(this.arrow.object);
    this.arrow = new Arrow(machine.reach * 0.022, new THREE.MeshBasicMaterial({color: 0xff7a45, toneMapped: false}));
    this.scene.add(this.arrow.object);
    this.machine = machine;
    this.rig = rig;
  }

  private get may(): boolean {
    return this.live.isOperator && !this.live.stale && (this.live.mode === RUNNING || this.live.mode === SAFE_STOP);
  }

  /** Where the pointer meets the machine. */
  private hit(event: PointerEvent): THREE.Vector3 | null {
    if (!this.machine || !this.rig?.tilts) return null;
    const {left, top, width, height} = this.canvas.getBoundingClientRect();
    const at = new THREE.Vector2(2 * (event.clientX - left) / width - 1, 1 - 2 * (event.clientY - top) / height);
    this.ray.setFromCamera(at, this.camera);
    return this.ray.intersectObject(this.machine.root, true)[0]?.point ?? null;
  }

  private press(event: PointerEvent): void {
    const at = this.may && event.button === 0 ? this.hit(event) : null;
    if (!at) return;
    this.grip.copy(this.machine!.structure.worldToLocal(at));
    this.start = {x: event.clientX, y: event.clientY, pointer: event.pointerId};
    this.canvas.setPointerCapture(event.pointerId);
    this.orbit.enabled = false;
    event.stopImmediatePropagation();
  }

  private move(event: PointerEvent): void {
    if (!this.start) {
      if (event.pointerType === 'mouse') this.canvas.style.cursor = this.may && this.hit(event) ? 'grab' : '';
      return;
    }
    const scale = MOST / (FULL * this.canvas.clientHeight);
    const right = scale * (event.clientX - this.start.x), up = scale * (this.start.y - event.clientY);
    // Along the ground as it is seen: sideways, and away from the eye.
    const sideways = new THREE.Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion).setZ(0).normalize();
    const away = new THREE.Vector3(-sideways.y, sideways.x, 0);
    this.pull.set(0, 0, 0).addScaledVector(sideways, right).addScaledVector(away, up);
    if (!this.rig!.tiltsTwoWays) this.pull.x = 0;  // it stands on a line along x
    if (this.pull.length() > MOST) this.pull.setLength(MOST);
  }

  private release(event: PointerEvent): void {
    if (!this.start) return;
    const moved = Math.hypot(event.clientX - this.start.x, event.clientY - this.start.y);
    const pull = this.pull.clone();
    this.cancel();
    if (moved < LEAST * this.canvas.clientHeight || pull.length() < LEAST) return;
    // Towards y is a moment about -x; towards x about y.
    const J = this.rig!.impulse;
    this.live.ask(impulse(this.rig!, -J * pull.y, J * pull.x), `push of ${amount(J * pull.length())} N m s`);
  }

  private cancel(): void {
    if (this.start && this.canvas.hasPointerCapture(this.start.pointer)) this.canvas.releasePointerCapture(this.start.pointer);
    this.start = null;
    this.orbit.enabled = true;
    this.pull.set(0, 0, 0);
  }

  draw(): void {
    const length = this.pull.length(), {arrow, machine, rig} = this;
    const shown = this.start !== null && length > LEAST && machine !== null && rig !== null;
    this.words.hidden = !shown;
    if (!shown) return arrow?.set(0);
    const at = machine.structure.localToWorld(this.grip.clone());
    arrow!.object.position.copy(at);
    arrow!.point(this.pull.clone().normalize());
    arrow!.set(length * machine.reach);
    const push = length * rig.impulse;
    say(this.words, `${amount(push)} N m s: ${amount(push / rig.impulseDuration)} N m for ${amount(1000 * rig.impulseDuration)} ms`);
    const tip = at.addScaledVector(this.pull, machine.reach).project(this.camera);
    const {clientWidth: width, clientHeight: height} = this.canvas;
    const x = Math.min(width - 110, Math.max(110, (tip.x + 1) / 2 * width)), y = Math.min(height - 30, Math.max(40, (1 - tip.y) / 2 * height));
    this.words.style.transform = `translate(-50%, -160%) translate(${x}px, ${y}px)`;
  }
}
