// Words on an overloaded bus, and on refreshes that were missed without a failure of their own. Pure except for the language.

import { mostFrequent } from './device_health';
import { count, duration } from './format';
import { t, word } from './i18n';
import type { Load } from './plant';
import type { Bus, Counts, ReadPlan } from './types';

export const texts = {
  'advice.overload': [
    'More is wanted than the wire carries, {load} times as much: refreshes are up to {stretch} times as long as configured. Refresh less often, run the line faster, or split the bus; “fieldcast plan” shows what is enough.',
    '需求超过总线能力，为其 {load} 倍：刷新周期最长为配置的 {stretch} 倍。请降低刷新频率、提高线路波特率或拆分总线；“fieldcast plan” 显示足够的方案。'],
  'advice.split': ['The wire time of its devices fits on {n} such lines: {lines}.', '其设备所需的总线时间可分配到 {n} 条此类线路：{lines}。'],
  'advice.heaviest': ['{device} needs the most: {share} of the wire.', '{device} 占用最多：总线的 {share}。'],
  'advice.late-failed': ['Not read in time. Failed exchanges meanwhile: {n} ({cause}). Each kept the wire until its timeout, up to {timeout}.', '未按时读取：期间有 {n} 次交换失败（{cause}），每次都占用总线直到超时（最长 {timeout}）。'],
  'advice.late-commands': ['Not read in time. Commands used the wire meanwhile: {n}.', '未按时读取：期间有 {n} 条命令占用了总线。'],
  'advice.late-slow': ['Not read in time, and no exchange failed: responses came later than planned, or the machine of the bridge was busy. Measured {measured} of planned {planned}.', '未按时读取，且无交换失败：应答晚于计划，或网桥所在机器繁忙。实测 {measured}，计划 {planned}。'],
} as const;

const number = (value: number): string => (value < 10 ? value.toFixed(2) : value.toFixed(0));
const percent = (share: number): string => `${Math.round(100 * share)} %`;

// The words that the bridge logs for the same bus; the rate of the line is not known here.
export const overloadText = (bus: Pick<Bus, 'planned_load' | 'stretch'>): string | undefined =>
  bus.planned_load > 1 || bus.stretch > 1.005 ? t('advice.overload', { load: number(bus.planned_load), stretch: number(bus.stretch) }) : undefined;

const mostLines = 8;

// Returns the devices of each line, if the load of a bus fits on several: the heaviest device first, each to the least loaded line.
export function splitOf(plan: ReadPlan): string[][] | undefined {
  const loads = new Map<string, number>();
  for (const group of plan.groups) loads.set(group.device, (loads.get(group.device) ?? 0) + group.load);
  const heaviest = [...loads].sort((a, b) => b[1] - a[1]);
  for (let n = 2; n <= Math.min(mostLines, heaviest.length); n++) {
    const lines = Array.from({ length: n }, () => ({ load: 0, devices: [] as string[] }));
    for (const [device, load] of heaviest) {
      const least = lines.reduce((best, line) => (line.load < best.load ? line : best));
      least.load += load;
      least.devices.push(device);
    }
    if (lines.every(({ load }) => load < 1)) return lines.map(({ devices }) => devices);
  }
  return undefined;
}

// What to do about an overloaded plan, as far as the plan shows it.
export function planAdvice(plan: ReadPlan): string[] {
  const loads = new Map<string, number>();
  for (const group of plan.groups) loads.set(group.device, (loads.get(group.device) ?? 0) + group.load);
  const [heaviest] = [...loads].sort((a, b) => b[1] - a[1]);
  const lines = splitOf(plan);
  return [heaviest ? t('advice.heaviest', { device: heaviest[0], share: percent(heaviest[1]) }) : '',
    lines ? t('advice.split', { n: lines.length, lines: lines.map((devices) => devices.join(' + ')).join(' | ') }) : ''].filter(Boolean);
}

const grown = (before: Counts, after: Counts): Counts =>
  Object.fromEntries(Object.entries(after).map(([cause, n]): [string, number] => [cause, n - (before[cause] ?? 0)]).filter(([, n]) => n > 0));
const sum = (counts: Counts): number => Object.values(counts).reduce((total, n) => total + n, 0);

// Explains refreshes that were "not read in time" between the first and the last of the reports. A response that comes too late, or never,
// holds the wire, so that reads of other channels miss their refresh without a failure of their own.
export function lateText(loads: readonly Load[], bus: Bus, timeout_ms: number): string | undefined {
  const late = loads.findIndex((load, index) => index > 0 && (load.missCauses['LATE'] ?? 0) > (loads[index - 1]!.missCauses['LATE'] ?? 0));
  if (late < 0) return undefined;
  const first = loads[Math.max(0, late - 2)]!, last = loads.at(-1)!;
  const failed = grown(first.causes, last.causes), commands = last.commands - first.commands;
  if (sum(failed)) return t('advice.late-failed', { n: count(sum(failed)), cause: word('cause', mostFrequent(failed)!), timeout: duration(timeout_ms) });
  if (commands > 0) return t('advice.late-commands', { n: count(commands) });
  return t('advice.late-slow', { measured: percent(bus.measured_load), planned: percent(bus.planned_load) });
}
