// Reports of the mock station: invented totals by day for the channels of the plant that match.

const day_ms = 86_400_000;

function tablesOf(url, plant) {
  const parameters = url.searchParams, to_ms = Number(parameters.get('to'));
  const patterns = parameters.getAll('channel').map((text) => new RegExp(`^${text.split('*').map((part) => part.replace(/[.+]/g, '\\$&')).join('[^/]*')}(/|$)`));
  const channels = plant.channels.filter(({ path }) => patterns.some((pattern) => pattern.test(path))).slice(0, 64);
  const rows = [0, 1, 2].map((n) => ({ from_ms: to_ms - (n + 1) * day_ms, to_ms: to_ms - n * day_ms, covered: 0.5, min: 1, mean: 2.5, max: 4 + n, integral: 60.125 }));
  return channels.map(({ path, kind }) => ({ channel: path, known: true, unit: kind.unit ?? '', rows }));
}

export function mockReports(plant) {
  const saved = new Map();
  const scheduled = [{ name: 'energy', channels: ['press-shop/*/flow-1'], by: 'day', every: 'day', at: '06:10', to: '/var/lib/fieldcast/reports', mail: ['crew'] }];
  const runs = [{ report: 'energy', via: 'folder', period: '2026-11-28', made_ms: Date.now() - 3_600_000, result: 'energy_2026-11-28.xlsx' }];
  return {
    saved,
    get: {
      '/api/report': (url) => {
        const format = url.searchParams.get('format');
        if (/\/\//.test(url.searchParams.get('channel'))) return [400, { error: 'channel: an empty part', hint: 'give BUS/DEVICE/CHANNEL' }];
        return format === 'json' ? [200, { tables: tablesOf(url, plant) }] : { csv: `${url.searchParams.getAll('channel').join('\n')}\n`, name: `report.${format}` };
      },
      '/api/reports': () => [200, { saved: [...saved].map(([name, query]) => ({ name, query, saved_by: 'anna', saved_ms: Date.now() })), scheduled, runs }],
    },
    post: {
      '/api/reports/save': ({ user }, { name, query }) => { saved.set(name, query); return [200, { name, query, saved_by: user, saved_ms: Date.now() }]; },
      '/api/reports/delete': (_, { name }) => (saved.delete(name) ? [200, {}] : [404, { error: 'there is no report of this name', hint: '' }]),
    },
  };
}
