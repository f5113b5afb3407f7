// The WebSocket to the station: connects, passes messages to the plant, detects a silent connection, and reconnects with
// growing pauses. A result is passed to its requester.

import { request } from './api';
import { StationClock } from './clock';
import type { CatalogueAnswer, Plant } from './plant';
import type { Alarm, Bridge, Bus, Description, Device, Interest, Result, Session, Site, Stream } from './types';

export type LiveState = 'connecting' | 'open' | 'lost';

interface Waiting {
  done: (result: Result) => void;
  failed: (error: Error) => void;
  timer: number;
}

const pingEvery_ms = 2000;
const silence_ms = 5000;  // without a byte: the connection counts as lost
const pauses_ms = [250, 500, 1000, 2000, 4000, 8000];
const resultWithin_ms = 30_000;

// hint: the advice of the station.
export class Refused extends Error {
  constructor(message: string, readonly hint: string) {
    super(message);
  }
}

export class Live {
  state: LiveState = 'connecting';
  lostAt = 0;  // performance.now()
  retryAt = 0;
  readonly clock = new StationClock();
  dropped = 0;  // frames that this page was too slow for
  roundTrip_ms = NaN;
  onLoginRequired: () => void = () => {};
  private socket: WebSocket | undefined;
  private tries = 0;
  private next = 1;
  private heardAt = 0;
  private pingSent = 0;
  private retryTimer = 0;
  private ended = false;
  private readonly asked = new Map<number, Waiting>();  // by the client's id
  private readonly requests = new Map<string, Waiting>();  // by the station's request_id
  private readonly early = new Map<string, Result>();  // results that arrived before resultOf()
  private readonly subscriptions = new Map<string, { count: number; refresh_ms?: number }>();

  constructor(private readonly plant: Plant) {
    setInterval(() => this.watch(), pingEvery_ms);
    addEventListener('online', () => this.retryNow());
    document.addEventListener('visibilitychange', () => document.hidden || this.retryNow());
  }

  now(): number { return this.clock.now(); }

  // `catalogue`: a request that is already pending, for the first connection.
  start(catalogue?: Promise<CatalogueAnswer>): void {
    this.ended = false;
    const address = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/live`;
    const socket = new WebSocket(address, 'fieldcast.1');
    socket.binaryType = 'arraybuffer';
    this.socket = socket;
    this.heardAt = performance.now();
    const mine = (): boolean => this.socket === socket;
    let opened = false;
    socket.onopen = () => {
      if (!mine()) return;
      opened = true;
      this.early.clear();  // a restarted station counts its requests from 1 again
      this.clock.restart();
      this.plant.restart();
      this.send({ subscribe: '*' });
      for (const [pattern, { refresh_ms }] of this.subscriptions) this.send({ subscribe: pattern, refresh_ms });
      void this.fetchCatalogue(socket, catalogue);
    };
    socket.onmessage = (event: MessageEvent<ArrayBuffer | string>) => {
      if (!mine()) return;
      this.heardAt = performance.now();
      if (typeof event.data === 'string') this.onMessage(event.data);
      else if (this.plant.applyFrame(event.data)) this.clock.observe(this.plant.base_ms);
    };
    socket.onclose = () => { if (mine()) this.onLost(opened); };
  }

  // Closes the connection at logout; no reconnect follows.
  stop(): void {
    this.ended = true;
    clearTimeout(this.retryTimer);
    const socket = this.socket;
    this.socket = undefined;
    socket?.close();
    this.setState('connecting');
  }

  // Requests a shorter refresh while a page shows the channels. Call the returned function to end it.
  subscribe(pattern: string, refresh_ms: number): () => void {
    const entry = this.subscriptions.get(pattern) ?? { count: 0, refresh_ms };
    entry.count++;
    this.subscriptions.set(pattern, entry);
    if (entry.count === 1) this.send({ subscribe: pattern, refresh_ms });
    return () => {
      if (--entry.count > 0) return;
      this.subscriptions.delete(pattern);
      this.send({ unsubscribe: pattern });
    };
  }

  // Rejects with Refused, or if no result arrives. A bigint is sent as a number with all its digits.
  write(channel: string, value: string | number | boolean | bigint, verify: boolean): Promise<Result> {
    const text = typeof value === 'bigint' ? String(value) : JSON.stringify(value);
    return this.ask(`"write":{"channel":${JSON.stringify(channel)},"value":${text},"verify":${verify}}`);
  }

  acquire(channel: string): Promise<Result> { return this.ask(`"acquire":{"channel":${JSON.stringify(channel)}}`); }

  // Resolves with the result of a command that was sent by HTTP.
  resultOf(requestId: string | number): Promise<Result> {
    const key = String(requestId);
    const early = this.early.get(key);
    if (this.early.delete(key)) return Promise.resolve(early!);
    return this.wait(this.requests, key);
  }

  private ask(members: string): Promise<Result> {
    const id = this.next++;
    if (!this.sendText(`{${members},"id":${id}}`)) return Promise.reject(new Refused('lost', ''));
    return this.wait(this.asked, id);
  }

  private wait<K>(table: Map<K, Waiting>, key: K): Promise<Result> {
    return new Promise((done, failed) => {
      const timer = window.setTimeout(() => {
        table.delete(key);
        failed(new Refused('no-result', ''));
      }, resultWithin_ms);
      table.set(key, { done, failed, timer });
    });
  }

  private settle<K>(table: Map<K, Waiting>, key: K, outcome: Result | Error): boolean {
    const waiting = table.get(key);
    if (!waiting) return false;
    table.delete(key);
    clearTimeout(waiting.timer);
    if (outcome instanceof Error) waiting.failed(outcome);
    else waiting.done(outcome);
    return true;
  }

  private send(message: unknown): boolean { return this.sendText(JSON.stringify(message)); }

  private sendText(text: string): boolean {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(text);
    return true;
  }

  private async fetchCatalogue(socket: WebSocket, first?: Promise<CatalogueAnswer>): Promise<void> {
    try {
      const after = this.plant.version;
      const answer = await (first ?? request<CatalogueAnswer>(after < 0 ? '/api/catalogue' : `/api/catalogue?after=${after}`));
      if (this.socket !== socket) return;
      this.plant.applyCatalogue(answer);
      this.setState('open');
      if (answer.version < this.wanted) void this.fetchCatalogue(socket);
    } catch {
      if (this.socket === socket) socket.close();
    }
  }
  private wanted = -1;

  private want(version: number): void {
    this.wanted = version;
    if (this.plant.version >= 0 && version > this.plant.version && this.socket) void this.fetchCatalogue(this.socket);
  }

  private onMessage(text: string): void {
    let message: { kind?: string } & Record<string, unknown>;
    try {
      message = JSON.parse(text);
    } catch {
      return;
    }
    const about = message as unknown;
    const plant = this.plant;
    switch (message.kind) {
      case 'hello':
        this.clock.observe(Number(message['now_ms']));
        this.want(Number(message['catalogue']));
        break;
      case 'catalogue': this.want(Number(message['version'])); break;
      case 'values': plant.applyTexts(message); break;
      case 'bus': plant.setBus(about as Bus); break;
      case 'bus_gone': plant.buses.delete(String(message['bus'])); plant.touch('buses'); break;
      case 'device': plant.setDevice(about as Device); break;
      case 'device_gone': plant.devices.delete(`${message['bus']}/${message['device']}`); plant.touch('devices'); break;
      case 'description': plant.setDescription(about as Description); break;
      case 'description_gone': plant.descriptions.delete(`${message['bus']}/${message['device']}`); break;
      case 'interest':
      case 'interest_gone': {
        const interest = about as Interest, key = `${interest.station} ${interest.pattern}`;
        message.kind === 'interest' ? plant.interests.set(key, interest) : plant.interests.delete(key);
        break;
      }
      case 'alarm': plant.setAlarm(about as Alarm); break;
      case 'session': {
        const session = about as Session;
        plant.setSession(session, performance.now());
        break;
      }
      case 'bridge': plant.bridges.set(String(message['bridge']), about as Bridge); plant.touch('bridges'); break;
      case 'bridge_gone': plant.bridges.delete(String(message['bridge'])); plant.touch('bridges'); break;
      case 'site': plant.sites.set(String(message['site']), about as Site); plant.touch('sites'); break;
      case 'stream': plant.stream = about as Stream; plant.touch('sites'); break;
      case 'plan': plant.plans.add(String(message['bus'])); plant.touch('plans'); break;
      case 'result': this.onResult(about as Result & { id?: number }); break;
      case 'refused':
        this.settle(this.asked, Number(message['id']), new Refused(String(message['error']), String(message['hint'] ?? '')));
        break;
      case 'lag': this.dropped += Number(message['dropped_frames']) || 0; break;
      case 'pong':
        this.roundTrip_ms = performance.now() - this.pingSent;
        this.clock.observe(Number(message['now_ms']));
        break;
    }
  }

  private onResult(result: Result & { id?: number }): void {
    if (result.id !== undefined && this.settle(this.asked, result.id, result)) return;
    const key = String(result.request_id);
    if (this.settle(this.requests, key, result)) return;
    this.early.set(key, result);
    if (this.early.size > 64) this.early.delete(this.early.keys().next().value!);
  }

  private watch(): void {
    if (!this.socket) return;
    if (performance.now() - this.heardAt > silence_ms) {
      const silent = this.socket;
      this.socket = undefined;
      silent.close();
      this.onLost(true);
      return;
    }
    this.pingSent = performance.now();
    this.send({ ping: this.next++ });
  }

  private onLost(opened: boolean): void {
    this.socket = undefined;
    for (const id of [...this.asked.keys()]) this.settle(this.asked, id, new Refused('lost', ''));
    for (const id of [...this.requests.keys()]) this.settle(this.requests, id, new Refused('lost', ''));
    if (this.ended) return;
    if (this.state === 'open') this.tries = 0;
    if (this.state !== 'lost') this.lostAt = performance.now();
    const pause = pauses_ms[Math.min(this.tries++, pauses_ms.length - 1)]! * (0.75 + Math.random() / 2);
    this.retryAt = performance.now() + pause;
    this.retryTimer = window.setTimeout(() => this.start(), pause);
    this.setState('lost');
    if (!opened) void this.checkLogin();
  }

  private retryNow(): void {
    if (this.state !== 'lost' || this.socket || this.ended) return;
    clearTimeout(this.retryTimer);
    this.start();
  }

  // A browser does not report why a socket was refused, so this requests the reason from the station.
  private async checkLogin(): Promise<void> {
    const me = await request<{ login: string }>('/api/me').catch(() => undefined);
    if (me?.login === 'required') this.onLoginRequired();
  }

  private setState(state: LiveState): void {
    if (this.state === state) return;
    this.state = state;
    this.plant.touch('connection');
  }
}
