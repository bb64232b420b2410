// Pieces that the machines are made of, and the two ways they are drawn: live, and as the twin's ghost.
import * as THREE from 'three';

import {SERIES} from '../palette';

export interface Skin {
  frame: THREE.Material;
  metal: THREE.Material;
  dark: THREE.Material;
  wheel: THREE.Material;
  accent: THREE.Material;
  marks: THREE.Material[];  // gyro j's colour
}

export function liveSkin(): Skin {
  const standard = (color: number, metalness: number, roughness: number) =>
    new THREE.MeshStandardMaterial({color, metalness, roughness});
  return {
    frame: standard(0x8f9bad, 0.35, 0.45),
    metal: standard(0xc3cad6, 0.7, 0.3),
    dark: standard(0x4a5568, 0.35, 0.6),
    wheel: standard(0xd69a3c, 0.65, 0.32),
    accent: standard(0x4c8dff, 0.3, 0.4),
    marks: SERIES.map((colour) => standard(colour, 0.2, 0.45)),
  };
}

export function ghostSkin(): Skin {
  const ghost = new THREE.MeshBasicMaterial({color: 0x35c0b0, transparent: true, opacity: 0.14, depthWrite: false});
  return {frame: ghost, metal: ghost, dark: ghost, wheel: ghost, accent: ghost, marks: SERIES.map(() => ghost)};
}

function mesh(geometry: THREE.BufferGeometry, material: THREE.Material): THREE.Mesh {
  const made = new THREE.Mesh(geometry, material);
  made.castShadow = made.receiveShadow = material instanceof THREE.MeshStandardMaterial;
  return made;
}

/** A rod between two points. */
export function rod(from: THREE.Vector3, to: THREE.Vector3, radius: number, material: THREE.Material): THREE.Mesh {
  const along = to.clone().sub(from);
  const made = mesh(new THREE.CylinderGeometry(radius, radius, along.length(), 20), material);
  made.position.copy(from).addScaledVector(along, 0.5);
  made.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
  return made;
}

/** A ring about z. */
export function ring(radius: number, thickness: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.TorusGeometry(radius, thickness, 16, 96), material);
}

/** A plate about z, centred. */
export function plate(radius: number, height: number, material: THREE.Material): THREE.Mesh {
  const made = mesh(new THREE.CylinderGeometry(radius, radius, height, 64), material);
  made.rotation.x = Math.PI / 2;
  return made;
}

export function ball(radius: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.SphereGeometry(radius, 24, 16), material);
}

export function box(x: number, y: number, z: number, material: THREE.Material): THREE.Mesh {
  return mesh(new THREE.BoxGeometry(x, y, z), material);
}

/** A flywheel whose axis is x: rim, spokes that show the spin, hub. */
export function flywheel(radius: number, width: number, skin: Skin): THREE.Group {
  const made = new THREE.Group();
  const rim = mesh(new THREE.TorusGeometry(radius * 0.86, radius * 0.14, 18, 64), skin.wheel);
  rim.scale.z = width / (radius * 0.28);
  rim.rotation.y = Math.PI / 2;
  const hub = mesh(new THREE.CylinderGeometry(radius * 0.2, radius * 0.2, width * 1.15, 24), skin.dark);
  hub.rotation.z = Math.PI / 2;
  made.add(rim, hub);
  for (let i = 0; i < 5; ++i) {
    const angle = i * 2 * Math.PI / 5;
    const end = new THREE.Vector3(0, radius * 0.8 * Math.cos(angle), radius * 0.8 * Math.sin(angle));
    made.add(rod(new THREE.Vector3(), end, radius * 0.06, skin.metal));
  }
  return made;
}

/** A gimbal's frame about a wheel whose axis is x; it turns about `axis`. */
export function gimbalFrame(radius: number, axis: 'y' | 'z', skin: Skin, j: number): THREE.Group {
  const made = new THREE.Group();
  const loop = ring(radius * 1.22, radius * 0.06, skin.marks[j % skin.marks.length]!);
  if (axis === 'z') loop.rotation.x = Math.PI / 2;
  made.add(loop);
  const end = new THREE.Vector3(radius * 1.22, 0, 0);
  made.add(rod(end.clone().negate(), end, radius * 0.05, skin.metal));
  return made;
}

/** An arrow along z from its origin, whose length is set. */
export class Arrow {
  readonly object = new THREE.Group();
  private readonly shaft: THREE.Mesh;
  private readonly head: THREE.Mesh;

  constructor(private readonly thick: number, material: THREE.Material) {
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 16), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 20), material);
    this.shaft.rotation.x = this.head.rotation.x = Math.PI / 2;
    this.object.add(this.shaft, this.head);
    this.set(0);
  }

  set(length: number): void {
    this.object.visible = length > 1e-9;
    const head = Math.min(4 * this.thick, 0.5 * length), shaft = Math.max(length - head, 1e-9);
    this.shaft.scale.set(this.thick, shaft, this.thick);
    this.shaft.position.z = shaft / 2;
    this.head.scale.set(2.2 * this.thick, Math.max(head, 1e-9), 2.2 * this.thick);
    this.head.position.z = length - head / 2;
  }

  /** @param direction of length 1, in the frame of the parent */
  point(direction: THREE.Vector3): void {
    this.object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), direction);
  }
}

/** Words that always face the eye. */
export function label(text: string, height: number, colour: string): THREE.Sprite {
  const canvas = document.createElement('canvas');
  canvas.width = 256;
  canvas.height = 64;
  const context = canvas.getContext('2d')!;
  context.font = '500 38px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillStyle = colour;
  context.fillText(text, 128, 32);
  const made = new THREE.Sprite(new THREE.SpriteMaterial({map: new THREE.CanvasTexture(canvas), transparent: true, depthWrite: false, toneMapped: false}));
  made.scale.set(4 * height, height, 1);
  return made;
}
