// The fields that the page reads of the station's JSON messages; names and units as in openapi.yaml and live/README.md. Times are Unix ms.

export type Role = 'viewer' | 'operator' | 'programmer' | 'engineer';

export interface Me {
  user: string;
  role: Role | null;
  login: 'none' | 'session' | 'token' | 'required';
  version: string;
  store: boolean;
  now_ms: number;
}

export interface Channel {
  id: number;
  path: string;  // bus/device/channel
  type: string;
  unit: string;
  at: string;  // the address in the PLC's notation
  access: string;  // read-only, read-write, write-only
  mode: string;
  refresh_ms: number;  // 0: none
  limits: Record<string, number>;  // low-low, low, high, high-high, write-min, write-max
  description: string;
  bridge: string;
  digits?: number;  // configured decimals
  resolution?: number;  // decimals from the resolution of the channel
}

// What numbers of a channel need to be formatted.
export type Shown = Pick<Channel, 'type' | 'digits' | 'resolution'>;

// Of a device, from the configuration of its bridge.
export interface Description {
  bus: string;
  device: string;
  protocol: string;
  port: string;
  address: string;
  digits: Counts;  // by channel
  resolution: Counts;
}

// A station asked for channels.
export interface Interest {
  station: string;
  pattern: string;
  refresh_ms: number;
}

export type Counts = Record<string, number>;

export interface Bus {
  bus: string;
  bridge: string;
  state: string;
  utilisation: number;
  planned_load: number;
  measured_load: number;
  stretch: number;
  exchanges: number;
  samples: number;
  commands: number;
  deadline_misses: number;
  causes: Counts;
  misses: Counts;
  reported_ms: number;
  clock_ahead_ms?: number;  // the station's clock minus the bridge's
  closed_because?: string;
}

export interface LearnedArea {
  area: string;
  answer_time_ms: number;
  answer_spread_ms: number;
  largest_block: number;
  longest_block: number;
}

export interface Device {
  bus: string;
  device: string;
  state: string;
  exchanges: number;
  failures: number;
  retries: number;
  deadline_misses: number;
  answer_time_ms: number;
  answer_spread_ms: number;
  timeout_ms: number;
  pause_ms: number;
  areas: LearnedArea[];
  refused: string[];
  refused_gaps: string[];
  causes: Counts;
  reported_ms: number;
}

export interface Alarm {
  bus: string;
  device: string;
  channel: string;
  limit: string;
  priority: 'critical' | 'high' | 'medium' | 'low';
  state: 'unacknowledged' | 'acknowledged' | 'returned' | 'clear';
  active: boolean;
  value: number | null;
  since_ms: number;
  raised_ns: string;  // identifies the occurrence; a number would lose digits
  occurrences: number;
  chattering: boolean;
  acknowledged_by: string;
  acknowledged_ms: number | null;
  note: string;
  shelved_until_ms: number | null;
  shelved_by: string;
  suppressed: '' | 'maintenance';
}

export interface AlarmEvent {
  at_ms: number;
  bus: string;
  device: string;
  channel: string;  // empty: all alarms of the device
  limit: string;
  event: string;  // raised, cleared, acknowledged, shelved, ...
  value: number | null;
  who: string;
  note: string;
  until_ms: number | null;
}

export interface ReportRow {
  from_ms: number;
  covered: number;  // share of the period with a good value
  min: number | null;
  mean: number | null;
  max: number | null;
  integral: number | null;
}

export interface ReportTable {
  channel: string;
  unit: string;
  rows: ReportRow[];
}

export interface Reports {
  saved: { name: string; query: string }[];
  scheduled: { name: string; channels: string[]; by: string; every: string; at: string }[];
  runs: { report: string; result: string; made_ms: number }[];
}

export interface AuditEntry {
  at_ms: number;
  who: string;
  what: string;  // write, login, program, ...
  target: string;
  bytes_to_device: number;
  bytes_from_device: number;
  result: string;
}

export interface User {
  user: string;
  role: string;
  created_ms?: number | null;
}

export interface PlanPoint {
  area: string;
  first: number;
  count: number;
  channels: string[];  // names on the device
  period_ms: number | null;  // null: not in the timetable
  phase_ms: number | null;
  worst_gap_ms: number | null;
  stretch: number;
}

// Channels that share requests.
export interface PlanGroup {
  device: string;
  list: boolean;  // a request contains a list of ranges
  period_ms: number | null;
  phase_ms: number | null;  // from the start of the table to the end of a read
  slack_ms: number | null;
  load: number;  // share of the wire
  points: PlanPoint[];
}

export interface ReadPlan {
  bus: string;
  in_force_since_ms?: number | null;
  load: number;
  stretch: number;
  slot_ms: number | null;
  hyperperiod_ms: number | null;
  groups: PlanGroup[];
}

export interface Session {
  bus: string;
  device: string;
  state: string;
  who: string;
  bytes_to_device: number;
  bytes_from_device: number;
  since_ms: number;
  last_request: string;  // decoded; '' if it is not known
  last_request_ms: number | null;
}

export interface Bridge {
  bridge: string;
  host: string;
  version: string;
  standby_group: string;
  since_ms: number;
  buses: { bus: string; since_ms: number; serving: boolean }[];
}

export interface Site {
  site: string;
  connected: boolean;
  heard_ms: number | null;
  reported_ms: number | null;
  clock_ahead_ms?: number;
  backlog_records: number;
  backlog_bytes: number;
  backlog_since_ms: number | null;
  samples: number;
  late_samples: number;
  lost_samples: number;
  refused_messages: number;
}

export interface Stream {
  connected: boolean;
  reason: string;
  commands: boolean;
}

export interface Result {
  request_id: string | number;
  state: string;  // done, verified, rejected, failed, expired
  cause: string;
  reason: string;
  value: unknown;
}

// A text channel has t, text and quality.
export interface Series {
  channel: string;
  known: boolean;
  unit: string;
  type: string;
  bucket_ms: number;  // 0: raw samples
  t: number[];
  min: (number | null)[];
  max: (number | null)[];
  average: (number | null)[];
  last: (number | null)[];
  count: number[];
  bad: number[];
  text?: string[];
  quality?: string[];
  late?: { from_ms: number; to_ms: number; received_ms: number }[];  // samples of its device that arrived late
}

export interface History {
  from_ms: number;
  to_ms: number;
  series: Series[];
}

// Names of the texts of qualities in the order of the IDL; the index is the byte in a frame.
export const qualities = [
  'good', 'uncertain', 'bad-no-answer', 'bad-frame', 'bad-device-error', 'bad-range', 'bad-configuration', 'not-yet-read',
] as const;
export const notYetRead = 7;
export const isBad = (quality: number): boolean => quality >= 2 && quality !== notYetRead;

// Older than its bridge promised, with a tolerance for the transport; shown as stale with any quality.
export const isLate = (channel: Channel, age_ms: number): boolean =>
  channel.refresh_ms > 0 && channel.mode !== 'on-demand' && age_ms > 2.2 * channel.refresh_ms + 1500;
