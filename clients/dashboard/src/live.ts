// All that the page knows of the rig: filled by the socket, read by whoever draws. Data flows one way.
import {parse} from '@foxglove/rosmsg';
import {MessageReader} from '@foxglove/rosmsg2-serialization';

import {Ring} from './charts/ring_buffer';
import {type Channel, Connection, type Data, type Parameter, type ServerMessage, type Value} from './foxglove';
import {ClockDifference, Delay, Happenings, Heard, type Recording, type Tone} from './heard';
import {Layout, Numbers} from './layout';
import {
  FALLS, type Forecast, type Health, type Link, MODES, type Reply, type State, type Status, type Topic, type Topics,
  FAULT, SAFE_STOP, type Truth, VALID, seconds,
} from './messages';
import {Writer, type Request} from './requests';
import {Rig, degrees} from './rig';

export type {Recording, Tone} from './heard';

export const KEPT = 60;  // [s]
const FASTEST = 1100;    // messages a second that a ring has room for
const PATIENCE = 5000;   // for the owner's answer, which the gateway asks for during 2 s [ms]
export const STALE = 1;  // [s]
const ASK_EVERY = 250;   // how long what comes has waited [ms]
const LET_GO = 0.4;      // of floods that have waited so long [s]
const MOST_OPEN = 20;    // questions
const REMEMBERED = 10000;  // for which a gap is told [ms]
const RATED = 3;         // over which STATE is counted [s]
const FLOODS: readonly Topic[] = ['LIVE/STATE', 'SIM/TRUTH', 'TWIN/STATE'];  // a thousand a second

type Owner = 'INTEGRATOR/STATUS' | 'HARDWARE/STATUS';
export const DAEMONS: readonly Topic[] = ['INTEGRATOR/STATUS', 'HARDWARE/STATUS', 'CONTROLLER/STATUS', 'MIRROR/STATUS',
  'GATEWAY/STATUS'];

interface Subscribed { topic: Topic; reader: MessageReader; layout: Layout }

export class Live {
  rig: Rig | null = null;
  prefix = '';
  role = '';
  connected = false;
  everConnected = false;
  state: Heard<State> | null = null;
  twin: Heard<State> | null = null;
  truth: Heard<Truth> | null = null;
  health: Heard<Health> | null = null;
  forecast: Heard<Forecast> | null = null;
  link: Heard<Link> | null = null;
  readonly status = new Map<Topic, Heard<Status>>();
  recording: Recording = {on: false};
  lost = 0;  // STATE that never came to this page
  readonly happenings = new Happenings();

  // Tilt x y, tilt rate x y [deg, deg/s], disc rate [rad/s], gimbals [deg] x 4, torques [N m] x 2, rotors [%] x 4.
  readonly states = new Ring(KEPT * FASTEST, 15);
  readonly twins = new Ring(KEPT * FASTEST, 2);    // tilt x y [deg]
  // Contacts [N] x 4, > 0 carried by the lower track; holding moment [N m] x 2; kinetic and potential energy [J].
  readonly truths = new Ring(KEPT * FASTEST, 8);
  readonly healths = new Ring(KEPT * 120, 11);     // NIS, unknown moment x y [N m], NIS of each sensor x 8

  private readonly connection: Connection;
  private subscriptions = new Map<number, Subscribed>();
  private readonly writer = new Writer();
  private readonly asked = new Map<string, {what: string; timer: ReturnType<typeof setTimeout>}>();
  private answered = '';  // the last request that was
  private readonly clock = new ClockDifference();
  private readonly delay = new Delay();
  private letGoAt = -Infinity;  // [ms]
  private caughtUp = '';  // the answer that comes after all that this page was too slow for
  private listening = false;
  private said = {health: '', falls: false, epoch: -1n, sequence: -1n};
  private readonly lostBefore = new Map<Topic, number>();  // STATE, when a STATUS came last

  constructor(url: string, private readonly ready: (live: Live) => void) {
    this.connection = new Connection(url, {
      opened: () => this.opened(),
      closed: () => this.closed(),
      message: (message) => this.take(message),
      data: (data) => this.hear(data),
    });
    setInterval(() => this.askDelay(), ASK_EVERY);
  }

  /** Time of the gateway's clock [s]. */
  now(): number { return performance.now() * 1e-3 + this.clock.offset; }
  /** By the page's own clock [s]. */
  age(heard: Heard<unknown> | null | undefined): number { return heard ? 1e-3 * (performance.now() - heard.here) : Infinity; }
  /** STATE a second that came lately; 0: they are old. */
  get rate(): number {
    return this.state && !this.stale ? (this.states.size - this.states.before(this.state.at - RATED)) / RATED : 0;
  }
  get isOperator(): boolean { return this.role === 'operator'; }

  /** STATUS of whoever owns the plant, the last that spoke. */
  get owner(): Heard<Status> | null {
    const owners = (['INTEGRATOR/STATUS', 'HARDWARE/STATUS'] as Owner[]).map((t) => this.status.get(t));
    return owners.reduce<Heard<Status> | null>((a, b) => (b && (!a || b.at > a.at) ? b : a), null);
  }
  get isReal(): boolean { return this.owner !== null && this.owner === this.status.get('HARDWARE/STATUS'); }
  get mode(): number | null { return this.owner ? this.owner.value.mode : null; }
  get stale(): boolean { return !this.connected || this.age(this.state) > STALE; }
  /** By how much what is shown was behind lately, at most [s]; 0: it was not. */
  get late(): number {
    const {recent} = this.delay;
    return recent > STALE ? recent : 0;
  }
  /** Whether this page was too slow lately and let go of something. */
  get gaps(): boolean { return performance.now() - this.letGoAt < REMEMBERED; }

  happen(tone: Tone, who: string, text: string): void { this.happenings.add(tone, who, text); }

  /** Asks the owner for something. @param what in words, for the list of what happened */
  ask(request: Request, what: string): void {
    const signed = this.writer.sign(request);
    if (!this.connection.publish(1, signed)) return this.happen('bad', what, 'not asked: there is no connection');
    const timer = setTimeout(() => {
      this.asked.delete(signed.counter);
      this.happen('bad', what, 'not answered');
    }, PATIENCE);
    this.asked.set(signed.counter, {what, timer});
  }

  record(on: boolean): void {
    this.connection.send({op: 'setParameters', parameters: [{name: 'recording', value: on}]});
  }

  private opened(): void {
    this.connected = true;
    this.happen(this.everConnected ? 'good' : 'info', 'gateway', this.everConnected ? 'connected again' : 'connected');
    this.everConnected = true;
  }

  private closed(): void {
    if (this.connected) this.happen('bad', 'gateway', 'the connection is lost');
    this.connected = this.listening = false;
    this.caughtUp = '';
    this.delay.forget();
    this.subscriptions = new Map();
    this.said.sequence = -1n;
  }

  private take(message: ServerMessage): void {
    if (message.op === 'serverInfo' && 'name' in message) {
      this.prefix = message.metadata?.['prefix'] ?? '';
      this.role = message.metadata?.['role'] ?? 'observer';
    } else if (message.op === 'advertise' && 'channels' in message) {
      this.subscribe(message.channels);
    } else if (message.op === 'parameterValues' && 'parameters' in message) {
      if (message.id) this.hearDelay(message.id);
      this.takeParameters(message.parameters);
    } else if (message.op === 'status' && 'message' in message) {
      this.happen(message.level > 0 ? 'bad' : 'info', 'gateway', message.message);
    }
  }

  private subscribe(channels: Channel[]): void {
    const wanted = new Set<string>(['LIVE/STATE', 'SIM/TRUTH', 'TWIN/STATE', 'TWIN/HEALTH', 'TWIN/FORECAST',
      'HARDWARE/LINK', 'REPLY', ...DAEMONS]);
    for (const channel of channels) {
      const topic = channel.topic.slice(this.prefix.length + 1);
      if (!wanted.has(topic)) continue;
      const definitions = parse(channel.schema, {ros2: true});
      this.subscriptions.set(channel.id, {topic: topic as Topic, reader: new MessageReader(definitions),
        layout: new Layout(definitions)});
    }
    if (this.rig) this.listen();
    this.connection.send({op: 'getParameters', parameterNames: [], id: 'rig'});
    this.connection.send({op: 'subscribeParameterUpdates', parameterNames: ['recording']});
    if (this.isOperator) {
      this.connection.send({op: 'advertise', channels: [
        {id: 1, topic: `${this.prefix}/REQUEST`, encoding: 'json', schemaName: 'request'}]});
    }
  }

  /** The flood begins: best once the page can draw it. */
  listen(): void {
    if (this.listening || !this.connected) return;
    this.listening = true;
    this.subscribeTo([...this.subscriptions.keys()]);
  }

  private askDelay(): void {
    if (!this.listening || this.delay.open >= MOST_OPEN) return;
    const tooMuch = this.caughtUp === '' && this.delay.waited > LET_GO;
    if (tooMuch) this.connection.send({op: 'unsubscribe', subscriptionIds: this.floods()});
    const id = this.delay.ask();
    this.connection.send({op: 'getParameters', parameterNames: ['recording'], id});
    if (!tooMuch) return;
    this.caughtUp = id;
    this.letGoAt = performance.now();
  }

  /** Who is flooded lets go, reads what has come, and listens again. */
  private hearDelay(id: string): void {
    this.delay.answered(id);
    if (id !== this.caughtUp) return;
    this.caughtUp = '';
    this.delay.begin();
    this.said.sequence = -1n;  // what was let go of is not lost
    this.subscribeTo(this.floods());
  }

  private floods(): number[] {
    return [...this.subscriptions].filter(([, {topic}]) => FLOODS.includes(topic)).map(([id]) => id);
  }

  private subscribeTo(channels: number[]): void {
    this.connection.send({op: 'subscribe', subscriptions: channels.map((id) => ({id, channelId: id}))});
  }

  private takeParameters(parameters: Parameter[]): void {
    const values = new Map<string, Value>(parameters.map(({name, value}) => [name, value]));
    const recording = values.get('recording') as unknown as Recording | undefined;
    if (recording) this.takeRecording(recording);
    if (!values.has('rig.name')) return;
    this.rig = new Rig(values);
    this.ready(this);
  }

  private takeRecording(recording: Recording): void {
    if (recording.on !== this.recording.on) {
      this.happen(recording.error ? 'bad' : 'info', 'recording',
        recording.error ?? `${recording.on ? 'started' : 'ended'}: ${recording.file ?? ''}`);
    }
    this.recording = recording;
  }

  private hear(data: Data): void {
    const subscribed = this.subscriptions.get(data.subscription);
    if (!subscribed) return;
    const at = seconds(data.time);
    this.clock.hear(at);
    const heard = <T extends Topics[Topic]>(): Heard<T> => new Heard<T>(subscribed.reader, data.bytes, at);
    const numbers = (): Numbers => new Numbers(subscribed.layout, data.bytes);
    switch (subscribed.topic) {
      case 'LIVE/STATE': return this.hearState(heard(), numbers());
      case 'TWIN/STATE': return this.hearTwin(heard(), numbers());
      case 'SIM/TRUTH': return this.hearTruth(heard(), numbers());
      case 'TWIN/HEALTH': return this.hearHealth(heard());
      case 'TWIN/FORECAST': return this.hearForecast(heard());
      case 'HARDWARE/LINK': this.link = heard(); return;
      case 'REPLY': return this.hearReply(heard<Reply>().value);
      default: return this.hearStatus(subscribed.topic, heard());
    }
  }

  private hearState(heard: Heard<State>, n: Numbers): void {
    const epoch = n.int64('header.epoch');
    const sequence = n.int64('header.sequence');
    if (this.said.epoch !== epoch) {
      this.said.epoch = epoch;
      this.twin = this.forecast = null;
    } else if (this.said.sequence >= 0n && sequence > this.said.sequence + 1n) {
      this.lost += Number(sequence - this.said.sequence - 1n);
    }
    this.said.sequence = sequence;
    this.state = heard;
    const valid = n.int32('valid'), share = 100 / (this.rig?.nominalSpeed || 1);
    const tilts = (valid & VALID.tilt) !== 0, angle = (name: string, i: number) => degrees(n.double(name, i));
    const rotor = (j: number) => share * n.double('rotor_speed_rad_s', j), gimbal = (j: number) => angle('gimbal_angle_rad', j);
    this.states.push(heard.at, [tilts ? angle('tilt_rad', 0) : NaN, tilts ? angle('tilt_rad', 1) : NaN,
      angle('tilt_rate_rad_s', 0), angle('tilt_rate_rad_s', 1), (valid & VALID.disc) !== 0 ? n.double('disc_rate_rad_s') : NaN,
      gimbal(0), gimbal(1), gimbal(2), gimbal(3), n.double('drive_torque_nm', 0), n.double('drive_torque_nm', 1),
      rotor(0), rotor(1), rotor(2), rotor(3)]);
  }

  private hearTwin(heard: Heard<State>, n: Numbers): void {
    this.twin = heard;
    this.twins.push(heard.at, [degrees(n.double('tilt_rad', 0)), degrees(n.double('tilt_rad', 1))]);
  }

  private hearTruth(heard: Heard<Truth>, n: Numbers): void {
    this.truth = heard;
    const contact = (j: number) => n.double('contact_lower_n', j) - n.double('contact_upper_n', j);
    const held = (i: number) => n.double('holding_moment_nm', i);
    this.truths.push(heard.at, [contact(0), contact(1), contact(2), contact(3), held(0), held(1),
      n.double('kinetic_energy_j'), n.double('potential_energy_j')]);
  }

  private hearHealth(heard: Heard<Health>): void {
    this.health = heard;
    const {value} = heard;
    this.healths.push(heard.at, [value.nis_total, value.external_moment_nm[0]!, value.external_moment_nm[1]!,
      ...Array.from(value.nis, (nis, i) => (value.sensor_verdict[i] ? nis : NaN))]);
    const text = `${value.verdict} ${value.blame}`;
    if (text !== this.said.health && value.verdict !== 0) {
      const bad = value.verdict !== 1;
      if (bad || this.said.health.startsWith('2')) this.happen(bad ? 'bad' : 'good', 'twin', value.text);
    }
    this.said.health = text;
  }

  private hearForecast(heard: Heard<Forecast>): void {
    this.forecast = heard;
    const falls = heard.value.outcome === FALLS;
    if (falls && !this.said.falls) {
      this.happen('bad', 'forecast', `falls in ${seconds(heard.value.falls_in_ns).toFixed(2)} s`);
    }
    this.said.falls = falls;
  }

  private hearStatus(topic: Topic, heard: Heard<Status>): void {
    const before = this.status.get(topic);
    this.status.set(topic, heard);
    const service = topic.slice(0, topic.indexOf('/')).toLowerCase();
    const {mode, text} = heard.value;
    if (!before) {
      this.happen('info', service, `heard: ${heard.value.pid} on ${heard.value.host}, ${MODES[mode] ?? mode}`);
    } else if (before.value.mode !== mode) {
      const bad = mode >= SAFE_STOP && mode <= FAULT;
      this.happen(bad ? 'bad' : 'info', service,
        `${MODES[before.value.mode] ?? ''} → ${MODES[mode] ?? mode}${text ? `: ${text}` : ''}`);
    } else if (heard.at - before.at > 2 && this.lostBefore.get(topic) === this.lost) {  // else it was left out, as STATE was
      this.happen('good', service, 'is back');
    }
    this.lostBefore.set(topic, this.lost);
  }

  private hearReply(reply: Reply): void {
    const answered = `${reply.request_writer} ${reply.request_counter}`;
    if (answered === this.answered) return;  // each time that it was asked again, the owner answers again
    this.answered = answered;
    const own = reply.request_writer === this.writer.id ? this.asked.get(reply.request_counter.toString()) : undefined;
    if (own) {
      clearTimeout(own.timer);
      this.asked.delete(reply.request_counter.toString());
    }
    const done = reply.result === 1;
    this.happen(done ? 'good' : 'bad', own?.what ?? 'somebody else asked', `${done ? '' : 'refused: '}${reply.text}`);
  }
}
