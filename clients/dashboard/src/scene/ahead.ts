// The forecast in space: from the top of the structure's axis a dotted arc to the largest tilt that is to come, in the
// direction of the lean; and the circle beyond which it has fallen.
import * as THREE from 'three';

import {FALLS, type Forecast, type State} from '../messages';
import {type Rig, tiltOf} from '../rig';
import type {Machine} from './machine';

const DOTS = 14;
const STANDING = 0x2cc3a3, FALLING = 0xff5a36;
const LEAST = 0.01;  // [rad] of arc that is drawn

/** Point at `tilt` from the vertical towards where (x, y) points, `length` from the ground pivot. */
export function leaning(x: number, y: number, tilt: number, length: number): THREE.Vector3 {
  const flat = Math.hypot(x, y) || 1, out = length * Math.sin(tilt);
  return new THREE.Vector3(out * x / flat, out * y / flat, length * Math.cos(tilt));
}

export class Ahead {
  readonly object = new THREE.Group();
  private readonly colour = new THREE.MeshBasicMaterial({color: STANDING, transparent: true, opacity: 0.9, toneMapped: false});
  private readonly dots: THREE.Mesh[];
  private readonly peak: THREE.Mesh;
  private readonly mast: THREE.Mesh;
  private readonly limit: THREE.LineSegments;
  private readonly length: number;

  constructor(private readonly machine: Machine, private readonly rig: Rig) {
    this.length = 1.12 * machine.height;
    const size = 0.011 * machine.reach;
    const bead = new THREE.SphereGeometry(size, 10, 8);
    this.dots = Array.from({length: DOTS}, () => new THREE.Mesh(bead, this.colour));
    this.peak = new THREE.Mesh(new THREE.SphereGeometry(2.2 * size, 16, 12), this.colour);
    this.mast = new THREE.Mesh(new THREE.SphereGeometry(1.8 * size, 16, 12), new THREE.MeshBasicMaterial({color: 0x4c8dff, toneMapped: false}));
    this.limit = limitOf(rig, this.length);
    this.object.add(...this.dots, this.peak, this.mast, this.limit);
  }

  draw(state: State, forecast: Forecast | null): void {
    this.object.visible = this.rig.tilts;
    if (!this.rig.tilts) return;
    const axis = new THREE.Vector3().setFromMatrixColumn(this.machine.structure.matrixWorld, 2);
    this.mast.position.copy(axis).multiplyScalar(this.length);
    const lean = tiltOf(state.tilt_rad), falls = forecast?.outcome === FALLS;
    const peak = forecast ? Math.min(falls ? Math.max(forecast.peak_tilt_rad, this.rig.fallTilt) : forecast.peak_tilt_rad, 1.4) : lean;
    const shown = forecast !== null && Math.abs(peak - lean) > LEAST && lean > 1e-4;
    this.colour.color.setHex(falls ? FALLING : STANDING);
    this.dots.forEach((dot, i) => {
      dot.visible = shown;
      dot.position.copy(leaning(axis.x, axis.y, lean + (peak - lean) * (i + 1) / DOTS, this.length));
    });
    this.peak.visible = shown;
    this.peak.position.copy(this.dots[DOTS - 1]!.position);
    const near = lean / this.rig.fallTilt;
    (this.limit.material as THREE.LineBasicMaterial).opacity = falls ? 0.9 : 0.18 + 0.6 * Math.min(1, near);
  }
}

/** Dashes where the axis' top is when it falls; two marks for what stands on a line. */
function limitOf(rig: Rig, length: number): THREE.LineSegments {
  const points: THREE.Vector3[] = [], dashes = 48, dash = Math.PI / dashes;
  for (let i = 0; i < dashes; ++i) {
    const angle = 2 * dash * i;
    if (!rig.tiltsTwoWays && Math.abs(Math.cos(angle)) > 0.3) continue;
    for (const end of [angle, angle + dash]) points.push(leaning(Math.cos(end), Math.sin(end), rig.fallTilt, length));
  }
  return new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points),
    new THREE.LineBasicMaterial({color: FALLING, transparent: true, opacity: 0.2}));
}
