// What comes over the socket, as messages/*.lcm describe it: the fields that the page looks at.

export interface Header {
  epoch: bigint;
  sequence: bigint;
  tick: bigint;
  sim_time_ns: bigint;
}

export const VALID = {tilt: 1, discTilt: 2, disc: 4, gimbals: 8, rotors: 16, drives: 32} as const;

export interface State {
  header: Header;
  mode: number;
  valid: number;
  tilt_rad: Float64Array;
  tilt_rate_rad_s: Float64Array;
  disc_tilt_rad: Float64Array;
  disc_angle_rad: number;
  disc_rate_rad_s: number;
  gimbal_angle_rad: Float64Array;
  rotor_speed_rad_s: Float64Array;
  drive_torque_nm: Float64Array;
}

export interface Truth {
  header: Header;
  contact_lower_n: Float64Array;
  contact_upper_n: Float64Array;
  holding_moment_nm: Float64Array;
  external_moment_nm: Float64Array;
  kinetic_energy_j: number;
  potential_energy_j: number;
  drive_margin_nm: Float64Array;
}

export interface Status {
  header: Header;
  service: number;
  mode: number;
  disturbances: number;
  faults: number;
  pid: number;
  host: string;
  text: string;
  speed_factor: number;
  overruns: bigint;
  lateness_p50_ns: bigint;
  lateness_p99_ns: bigint;
  lateness_max_ns: bigint;
  compute_p50_ns: bigint;
  compute_p99_ns: bigint;
  compute_max_ns: bigint;
  kernel_dropped: bigint;
  malformed: bigint;
  unauthentic: bigint;
  gaps: BigInt64Array;
}

export interface Health {
  header: Header;
  verdict: number;
  blame: number;
  sensor_verdict: Int32Array;
  nis: Float64Array;
  nis_total: number;
  external_moment_nm: Float64Array;
  text: string;
}

export interface Forecast {
  header: Header;
  outcome: number;
  law: number;
  horizon_ns: bigint;
  falls_in_ns: bigint;
  peak_tilt_rad: number;
  peak_in_ns: bigint;
  saturates_in_ns: bigint;
  fall_probability: number;
}

export interface Link {
  header: Header;
  connected: number;
  round_trip_p50_ns: bigint;
  round_trip_max_ns: bigint;
  reconnects: bigint;
  host_bad: bigint;
  samples_missed: bigint;
  text: string;
}

export interface Reply {
  header: Header;
  request_writer: bigint;
  request_counter: bigint;
  verb: number;
  result: number;
  id: bigint;
  text: string;
}

/** Topics behind the rig's prefix that the page listens to, and what they carry. */
export interface Topics {
  'LIVE/STATE': State;
  'SIM/TRUTH': Truth;
  'TWIN/STATE': State;
  'TWIN/HEALTH': Health;
  'TWIN/FORECAST': Forecast;
  'HARDWARE/LINK': Link;
  'REPLY': Reply;
  'INTEGRATOR/STATUS': Status;
  'HARDWARE/STATUS': Status;
  'CONTROLLER/STATUS': Status;
  'MIRROR/STATUS': Status;
  'GATEWAY/STATUS': Status;
}
export type Topic = keyof Topics;

export const MODES: Record<number, string> = {
  0: 'HELD', 1: 'RUNNING', 2: 'PAUSED', 3: 'SAFE STOP', 4: 'FALLEN', 5: 'FAULT', 16: 'WAITING', 17: 'ACTIVE',
};
/** What that means, where the owner does not say more. */
export const MODE_WORDS: Record<number, string> = {
  0: 'held at its start: arm to let it go', 1: 'the physics runs, the law is obeyed', 2: 'time stands still',
  3: 'the drives are in their safe stop', 4: 'it has fallen', 5: 'a fault stopped it',
};
export const HELD = 0, RUNNING = 1, PAUSED = 2, SAFE_STOP = 3, FALLEN = 4, FAULT = 5;
export const FALLS = 2;  // outcome of a forecast
export const SENSORS = ['gyro', 'accelerometer', 'disc', 'gimbals', 'rotors', 'currents', 'bus voltage', 'load cell'];
export const SENSOR_VERDICTS = ['', 'agrees', 'disagrees', 'stuck', 'silent', 'insane', 'late'];
export const HARDWARE_SOURCE = 2;

export const seconds = (ns: bigint): number => Number(ns) * 1e-9;
