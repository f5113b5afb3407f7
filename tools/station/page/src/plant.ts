// All data received from the station: values in typed arrays by channel id, the catalogue, buses, devices, alarms,
// sessions, bridges. No network and no screen. Ids are valid for one connection: frames of a new one wait until its catalogue
// has arrived, so that no value is shown under the name of a different channel.

import { neverAcquired, parseFrame } from './frame';
import type { Frame } from './frame';
import { notYetRead, isBad } from './types';
import { RecentValues } from './recent_values';
import { SessionRates } from './session_rate';
import type { Alarm, Bridge, Bus, Channel, Counts, Description, Device, Interest, Session, Site, Stream } from './types';

export type Topic = 'catalogue' | 'buses' | 'devices' | 'alarms' | 'sessions' | 'bridges' | 'plans' | 'sites' | 'connection';

export interface CatalogueAnswer {
  version: number;
  full: boolean;
  channels: unknown[][];
  gone: number[];
}

export interface Load {
  at_ms: number;
  utilisation: number;
  misses: number;
  exchanges: number;
  commands: number;
  causes: Counts;  // of failed exchanges
  missCauses: Counts;  // of missed refreshes
}

export interface Tally {
  all: number;
  bad: number;
  unread: number;
}

const mostWaiting = 1000;  // frames that wait for the catalogue
const mostLoads = 300;  // for each bus: five minutes
const mostIds = 1 << 20;

export const alarmKey = (alarm: { bus: string; device: string; channel: string; limit: string }): string =>
  `${alarm.bus}/${alarm.device}/${alarm.channel}/${alarm.limit}`;

export function channelFromRow(row: unknown[]): Channel {
  const [id, path, type, unit, at, access, mode, refresh_ms, limits, description, bridge] = row as [
    number, string, string, string, string, string, string, number, Record<string, number> | null, string, string];
  return { id, path, type, unit, at, access, mode, refresh_ms, limits: limits ?? {}, description, bridge };
}

export class Plant {
  version = -1;  // of the catalogue; -1: none yet
  value = new Float64Array(0);
  acquired_ms = new Float64Array(0);  // 0: never
  quality = new Uint8Array(0);
  stamp = new Uint32Array(0);  // the turn of the channel's last change
  turn = 1;  // grows with each frame
  samples = 0;
  base_ms = 0;  // the newest acquisition of the last frame; 0: it had no values
  qualityChanges = 0;  // grows when the quality of any channel changes
  readonly texts = new Map<number, string>();  // values that are not plain numbers
  readonly channels = new Map<number, Channel>();
  readonly ids = new Map<string, number>();  // by path
  readonly buses = new Map<string, Bus>();
  readonly devices = new Map<string, Device>();  // bus/device
  readonly descriptions = new Map<string, Description>();  // bus/device
  readonly interests = new Map<string, Interest>();  // by station and pattern
  readonly alarms = new Map<string, Alarm>();
  readonly sessions = new Map<string, Session>();  // bus/device
  readonly rates = new SessionRates();
  readonly recent = new RecentValues();
  readonly bridges = new Map<string, Bridge>();
  readonly sites = new Map<string, Site>();
  stream: Stream | undefined;  // undefined: this station reads none
  readonly plans = new Set<string>();  // buses with a changed read plan, until a page has fetched it
  readonly loads = new Map<string, Load[]>();  // of each bus, oldest first
  readonly changed = new Set<Topic>();  // since the last painting
  onChange: () => void = () => {};
  onAlarm: (alarm: Alarm) => void = () => {};  // also while nothing is painted
  onValue: ((id: number) => void) | undefined;  // for a page that needs every sample of a channel
  watched = -1;  // the id for onValue; -1 after restart()
  private waiting: (ArrayBuffer | Record<string, unknown>)[] | undefined = [];

  // Called for a new connection: its ids are not yet valid, and the station sends buses and alarms again.
  restart(): void {
    this.waiting = [];
    this.watched = -1;
    this.version = -1;
    for (const map of [this.buses, this.devices, this.descriptions, this.interests, this.alarms, this.sessions, this.bridges, this.sites]) map.clear();
    this.stream = undefined;
    this.rates.clear();
    for (const topic of ['buses', 'devices', 'alarms', 'sessions', 'bridges', 'sites'] as const) this.touch(topic);
  }

  // `at`: monotonic time of the arrival in milliseconds.
  setSession(session: Session, at: number): void {
    const path = `${session.bus}/${session.device}`;
    this.sessions.set(path, session);
    this.rates.report(path, session, at);
    this.touch('sessions');
  }

  touch(topic: Topic): void {
    this.changed.add(topic);
    this.onChange();
  }

  applyCatalogue(answer: CatalogueAnswer): void {
    const first = this.version < 0;
    if (answer.full) {
      this.channels.clear();
      this.ids.clear();
      if (first) this.forgetValues();
    }
    for (const id of answer.gone) this.drop(id);
    for (const row of answer.channels) {
      const channel = channelFromRow(row);
      this.reserve(channel.id);
      this.channels.set(channel.id, channel);
      this.ids.set(channel.path, channel.id);
      this.describe(channel);
    }
    this.version = answer.version;
    const waiting = this.waiting ?? [];
    this.waiting = undefined;
    for (const item of waiting) item instanceof ArrayBuffer ? this.applyFrame(item) : this.applyTexts(item);
    this.touch('catalogue');
  }

  // Returns false if the bytes are not a frame of this protocol.
  applyFrame(bytes: ArrayBuffer): boolean {
    if (this.waiting) {
      if (this.waiting.length < mostWaiting) this.waiting.push(bytes);
      return true;
    }
    const frame = parseFrame(bytes);
    if (!frame) return false;
    this.applyRows(frame);
    return true;
  }

  // Handles a `values` message: texts, and integers that a double cannot represent.
  applyTexts(message: Record<string, unknown>): void {
    if (this.waiting) {
      if (this.waiting.length < mostWaiting) this.waiting.push(message);
      return;
    }
    const { id, value, acquired_ms, quality } = message as {
      id: number[]; value: (string | null)[]; acquired_ms: (number | null)[]; quality: number[] };
    this.turn++;
    id.forEach((each, index) => {
      const text = value[index];
      if (text === null || text === undefined) this.texts.delete(each);
      else this.texts.set(each, String(text));
      this.set(each, NaN, acquired_ms[index] ?? 0, quality[index] ?? notYetRead);
    });
    this.onChange();
  }

  // Counts the channels of each bus; '' counts all.
  count(): Map<string, Tally> {
    const total: Tally = { all: 0, bad: 0, unread: 0 };
    const tallies = new Map([['', total]]);
    for (const [id, channel] of this.channels) {
      const bus = channel.path.slice(0, channel.path.indexOf('/'));
      let tally = tallies.get(bus);
      if (!tally) tallies.set(bus, (tally = { all: 0, bad: 0, unread: 0 }));
      const quality = this.quality[id] ?? notYetRead;
      for (const each of [total, tally]) {
        each.all++;
        if (isBad(quality)) each.bad++;
        else if (quality === notYetRead) each.unread++;
      }
    }
    return tallies;
  }

  setBus(bus: Bus): void {
    this.buses.set(bus.bus, bus);
    const loads = this.loads.get(bus.bus) ?? [];
    const last = loads.at(-1);
    const load = { at_ms: bus.reported_ms, utilisation: bus.utilisation, misses: bus.deadline_misses, exchanges: bus.exchanges,
      commands: bus.commands, causes: bus.causes, missCauses: bus.misses };
    if (!last || bus.reported_ms > last.at_ms) loads.push(load);
    if (loads.length > mostLoads) loads.shift();
    this.loads.set(bus.bus, loads);
    this.touch('buses');
  }

  setDevice(device: Device): void {
    this.devices.set(`${device.bus}/${device.device}`, device);
    this.touch('devices');
  }

  setDescription(about: Description): void {
    this.descriptions.set(`${about.bus}/${about.device}`, about);
    for (const name of new Set([...Object.keys(about.digits), ...Object.keys(about.resolution)])) {
      const channel = this.channelOf(`${about.bus}/${about.device}/${name}`);
      if (channel) this.describe(channel);
    }
    this.touch('catalogue');
  }

  channelOf(path: string): Channel | undefined { return this.channels.get(this.ids.get(path) ?? -1); }

  private describe(channel: Channel): void {
    const end = channel.path.lastIndexOf('/'), about = this.descriptions.get(channel.path.slice(0, end)), name = channel.path.slice(end + 1);
    if (about) Object.assign(channel, { digits: about.digits[name], resolution: about.resolution[name] });
  }

  setAlarm(alarm: Alarm): void {
    if (alarm.state === 'clear' && !alarm.active && !alarm.shelved_until_ms && !alarm.suppressed) this.alarms.delete(alarmKey(alarm));
    else this.alarms.set(alarmKey(alarm), alarm);
    this.onAlarm(alarm);
    this.touch('alarms');
  }

  private applyRows(frame: Frame): void {
    const { id, value, age_ms, quality, base_ms } = frame;
    this.base_ms = base_ms;
    this.turn++;
    for (let row = 0; row < id.length; row++) {
      const age = age_ms[row]!;
      if (!Number.isNaN(value[row]!)) this.texts.delete(id[row]!);
      this.set(id[row]!, value[row]!, age === neverAcquired ? 0 : base_ms - age, quality[row]!);
    }
    this.onChange();
  }

  private set(id: number, value: number, acquired_ms: number, quality: number): void {
    if (id >= this.value.length && !this.reserve(id)) return;
    this.value[id] = value;
    this.acquired_ms[id] = acquired_ms;
    if (this.quality[id] !== quality) {
      this.quality[id] = quality;
      this.qualityChanges++;
    }
    this.stamp[id] = this.turn;
    this.samples++;
    if (id === this.watched) this.onValue?.(id);
  }

  private drop(id: number): void {
    const channel = this.channels.get(id);
    if (channel && this.ids.get(channel.path) === id) this.ids.delete(channel.path);
    this.channels.delete(id);
    this.texts.delete(id);
  }

  private forgetValues(): void {
    this.value.fill(NaN);
    this.recent.clear();
    this.acquired_ms.fill(0);
    this.quality.fill(notYetRead);
    this.texts.clear();
    this.turn++;
    this.stamp.fill(this.turn);
    this.qualityChanges++;
  }

  // Returns false if the id exceeds the limit of a station.
  private reserve(id: number): boolean {
    if (id < this.value.length) return true;
    if (id >= mostIds) return false;
    const size = Math.min(mostIds, Math.max(1024, 2 * id));
    const grown = <A extends Float64Array | Uint8Array | Uint32Array>(from: A, to: A, fill: number): A => {
      to.fill(fill, from.length);
      to.set(from);
      return to;
    };
    this.value = grown(this.value, new Float64Array(size), NaN);
    this.acquired_ms = grown(this.acquired_ms, new Float64Array(size), 0);
    this.quality = grown(this.quality, new Uint8Array(size), notYetRead);
    this.stamp = grown(this.stamp, new Uint32Array(size), 0);
    return true;
  }
}
