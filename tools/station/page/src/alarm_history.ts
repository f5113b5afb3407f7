// Alarm events of a time range.

import { limitText } from './alarm_actions';
import type { Context } from './context';
import { csvTime } from './csv';
import { fullTime, shownValue } from './format';
import { t, word } from './i18n';
import { PastList } from './past';
import { channelLink, link } from './router';
import type { AlarmEvent } from './types';

const shapes: Record<string, string> = { raised: '▲', cleared: '◇', acknowledged: '✓', shelved: '◷', chattering: '⚠' };
const pathOf = (event: AlarmEvent): string => [event.bus, event.device, event.channel].filter(Boolean).join('/');

function valueText(context: Context, event: AlarmEvent): string {
  if (event.value === null) return '';
  const channel = context.plant.channelOf(pathOf(event));
  return `${shownValue(event.value, channel)}${channel?.unit ? ` ${channel.unit}` : ''}`;
}

const noteText = (event: AlarmEvent): string =>
  [event.until_ms ? t('alarms.until', { time: fullTime(event.until_ms).slice(0, 16) }) : '', event.note].filter(Boolean).join(' · ');

export const alarmHistory = (context: Context): PastList<AlarmEvent> => new PastList<AlarmEvent>(context, {
  label: t('alarms.history'), className: 'event-table', parts: ['history'], path: '/api/alarms', itemsOf: (answer) => answer['events'] ?? [],
  tone: (event) => `e-${event.event.replaceAll(' ', '-')}`,
  textOf: (event) => `${pathOf(event)} ${event.event} ${event.limit} ${event.who} ${event.note}`,
  none: t('alarms.no-events'), file: 'alarms.csv', csvHead: ['at', 'event', 'bus', 'device', 'channel', 'limit', 'value', 'who', 'note', 'until'],
  csvRow: (event) => [csvTime(event.at_ms), event.event, event.bus, event.device, event.channel, event.limit, event.value, event.who, event.note, csvTime(event.until_ms)],
  columns: [
    { key: 'at', label: t('alarms.at'), text: (event) => fullTime(event.at_ms) },
    { key: 'event', label: t('alarms.event'), text: (event) => `${shapes[event.event] ?? '○'} ${word('event', event.event)}` },
    { key: 'channel', label: t('alarms.channel'), text: pathOf, link: (event) => (event.channel ? channelLink(pathOf(event)) : link('devices', [event.bus, event.device])) },
    { key: 'limit', label: t('alarms.limit'), text: (event) => (event.limit ? limitText(event) : '') },
    { key: 'value', label: t('alarms.value'), text: (event) => valueText(context, event) },
    { key: 'who', label: t('alarms.who'), text: (event) => event.who },
    { key: 'note', label: t('alarms.note'), text: noteText, hint: noteText },
  ],
});
