// What the axles bear: an arrow from each tip, along the force on it, and a glow, both by its size.
import * as THREE from 'three';

import type {Truth} from '../messages';
import type {Machine} from './machine';
import {Arrow} from './parts';

const FORCE = 0xff8a3d;
const LONGEST = 3;  // of what an axle bears at rest

export class Contacts {
  readonly object = new THREE.Group();
  private readonly marks: {arrow: Arrow; glow: THREE.Sprite}[];
  private readonly at = new THREE.Vector3();
  private readonly up = new THREE.Vector3();

  constructor(private readonly machine: Machine) {
    const thick = machine.reach * 0.012;
    const material = new THREE.MeshBasicMaterial({color: FORCE, toneMapped: false});
    const map = glowTexture();
    this.marks = (machine.tips ?? []).map(() => {
      const arrow = new Arrow(thick, material);
      const glow = new THREE.Sprite(new THREE.SpriteMaterial({map, transparent: true, depthWrite: false, depthTest: false, toneMapped: false}));
      this.object.add(glow, arrow.object);
      return {arrow, glow};
    });
  }

  /** @param truth null: the forces are not known */
  draw(truth: Truth | null): void {
    const {machine} = this;
    machine.structure.updateWorldMatrix(true, false);
    this.up.setFromMatrixColumn(machine.structure.matrixWorld, 2);
    this.marks.forEach(({arrow, glow}, j) => {
      const force = truth ? truth.contact_lower_n[j]! - truth.contact_upper_n[j]! : 0;
      const share = Math.min(LONGEST, Math.abs(force) / (machine.restForce || 1));
      machine.tips![j]!.getWorldPosition(this.at);
      arrow.set(0.2 * machine.reach * Math.sqrt(share));
      arrow.object.position.copy(this.at);
      arrow.point(force < 0 ? this.up.clone().negate() : this.up);
      glow.visible = share > 0.01;
      glow.position.copy(this.at);
      glow.scale.setScalar(machine.reach * (0.1 + 0.12 * Math.sqrt(share)));
      glow.material.opacity = Math.min(1, 0.3 + 0.25 * share);
    });
  }
}

function glowTexture(): THREE.Texture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const context = canvas.getContext('2d')!;
  const fade = context.createRadialGradient(32, 32, 0, 32, 32, 32);
  fade.addColorStop(0, 'rgba(255, 170, 90, 1)');
  fade.addColorStop(0.25, 'rgba(255, 138, 61, 0.7)');
  fade.addColorStop(1, 'rgba(255, 138, 61, 0)');
  context.fillStyle = fade;
  context.fillRect(0, 0, 64, 64);
  return new THREE.CanvasTexture(canvas);
}
