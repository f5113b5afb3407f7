// The card of a channel whose value is not good: since when, the last good value, what its device does, what to check.

import { html } from './markup';
import { nothing } from 'lit-html';
import type { TemplateResult } from 'lit-html';
import { query, request } from './api';
import type { Context } from './context';
import { failedShare, mostFrequent } from './device_health';
import { age, count, duration, fullTime, percent } from './format';
import { t, word } from './i18n';
import type { Key } from './i18n';
import { link } from './router';
import { notYetRead, qualities } from './types';
import type { Channel, Device, History } from './types';
import { fact } from './view';

export const texts = {
  'fault.title': ['Why there is no good value', '为何没有有效值'], 'fault.since': ['Since', '开始时间'], 'fault.good': ['Last good value', '最近的有效值'],
  'fault.never': ['none since the bridge started', '网桥启动以来没有'], 'fault.before': ['before {time}', '{time} 之前'], 'fault.after': ['after the last good value', '最近的有效值之后'],
  'fault.attempts': ['Attempts on this device', '对此设备的尝试'],
  'fault.attempts-text': ['{failed} of {all} exchanges failed ({share}), most often: {cause}; {retries} retries', '{all} 次交换中 {failed} 次失败（{share}），最常见：{cause}；重试 {retries} 次'],
  'fault.opened': ['{n} failed while this page is open', '本页打开期间失败 {n} 次'], 'fault.timeout': ['waits {time} for a response', '等待应答 {time}'],
  'fault.check': ['What to check', '检查内容'], 'fault.device': ['Device {device}', '设备 {device}'],
  'check.uncertain': ['Is the wire overloaded, or is a device of this bus being programmed? See the read plan.', '总线是否过载，或该总线上的设备是否正在编程？请查看读取计划。'],
  'check.bad-no-answer': ['Power of the device; cable and adapter; A and B swapped; station address, baud rate and parity of the device.', '设备电源；电缆与适配器；A、B 是否接反；设备的站号、波特率和校验。'],
  'check.bad-frame': ['Parity and baud rate; wiring, shield and termination; a second device with the same address.', '校验与波特率；接线、屏蔽和终端电阻；是否有相同地址的另一台设备。'],
  'check.bad-device-error': ['The device refuses this address: compare the address with its manual. The page of the device lists all refused addresses.', '设备拒绝此地址：请对照其手册核对地址。设备页面列出所有被拒绝的地址。'],
  'check.bad-range': ['Type, encoding and text length of the channel; or the device has no value here, such as an unconnected sensor.', '通道的类型、编码和文本长度；或设备此处没有数值，例如传感器未连接。'],
  'check.bad-configuration': ['Address and type of the channel in the configuration of the bridge.', '网桥配置中该通道的地址和类型。'],
} as const;

// Returns the time of the first stored sample without a value after the last good one; `whole`: nothing before it is stored.
export function badSince(history: History): { at_ms: number; whole: boolean } | undefined {
  const series = history.series[0];
  if (!series?.bad) return undefined;
  let first = series.t.length;
  while (first > 0 && (series.bad[first - 1] ?? 0) > 0) first--;
  return first === series.t.length ? undefined : { at_ms: series.t[first]!, whole: first === 0 };
}

const mostBack_ms = 30 * 86_400_000;
const points = 1000;

export class ChannelFault {
  private since: { at_ms: number; whole: boolean } | undefined;
  private askedFor = -1;  // acquired_ms of the last request
  private failuresAtStart: number | undefined;
  private readonly asked = new AbortController();

  constructor(private readonly context: Context, private readonly arrived: () => void) {}

  close(): void { this.asked.abort(); }

  // `value`: the text of the last good value.
  draw(channel: Channel, quality: number, acquired_ms: number, value: string): TemplateResult | typeof nothing {
    const [bus, name] = channel.path.split('/');
    const device = this.context.plant.devices.get(`${bus}/${name}`);
    if (device) this.failuresAtStart ??= device.failures;
    if (quality === 0 || quality === notYetRead) {
      this.since = undefined;
      this.askedFor = -1;
      return nothing;
    }
    if (this.askedFor !== acquired_ms) void this.load(channel.path, acquired_ms);
    return html`<section class="card fault" aria-label=${t('fault.title')}><h2>${t('fault.title')}</h2><dl class="facts about">
      ${fact(t('fault.since'), this.sinceText(acquired_ms))}
      ${fact(t('fault.good'), acquired_ms ? html`<b>${value} ${channel.unit}</b> <span class="muted">${fullTime(acquired_ms)}</span>` : t('fault.never'))}
      ${device ? fact(t('fault.attempts'), this.attempts(device), true) : nothing}
      ${fact(t('fault.check'), t(`check.${qualities[quality]!}` as Key), true)}</dl>
      <p class="links"><a href=${link('devices', [bus!, name!])}>${t('fault.device', { device: `${bus}/${name}` })}</a> <a href=${link('plan', [bus!])}>${t('overview.plan')}</a></p></section>`;
  }

  private sinceText(acquired_ms: number): string {
    const { since } = this;
    if (!since) return acquired_ms ? t('fault.after') : '–';
    const ago = age(this.context.now() - since.at_ms), at = fullTime(since.at_ms);
    return `${since.whole && !acquired_ms ? t('fault.before', { time: at }) : at} (${ago})`;
  }

  private attempts(device: Device): string {
    const { failures, exchanges, retries } = device, opened = failures - (this.failuresAtStart ?? failures);
    return [t('fault.attempts-text', { failed: count(failures), all: count(exchanges), share: percent(failedShare(device), 1), cause: word('cause', mostFrequent(device.causes) ?? 'NONE'), retries: count(retries) }),
      t('fault.opened', { n: count(Math.max(0, opened)) }), t('fault.timeout', { time: duration(device.timeout_ms) })].join(' · ');
  }

  private async load(path: string, acquired_ms: number): Promise<void> {
    this.askedFor = acquired_ms;
    if (!this.context.me.store) return;
    const now = Math.ceil(this.context.now()), from = Math.floor(Math.max(acquired_ms, now - mostBack_ms));
    try {
      this.since = badSince(await request<History>(query('/api/history', { channel: path, from, to: Math.max(now, from + 1000), points }), undefined, this.asked.signal));
      this.arrived();
    } catch {
      // without stored samples, the time of the last good value remains
    }
  }
}
