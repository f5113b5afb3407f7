// Dashboards and pictures of the mock station. It checks only what the page must react to: the station's own check is tested in
// tests/tools/station/dashboard.

const device = 'boiler-house/device-01';
const pumps = {
  name: 'pumps', title: 'Pump ${pump}', parameters: [{ name: 'pump', title: 'Pump', default: '01', values: ['01', '02', '03'] }], grid: { columns: 12, row_px: 40 },
  widgets: [
    { kind: 'text', at: [0, 0, 12, 1], text: 'Boiler house, pump ${pump}', opens: 'pumps?pump=03' },
    { kind: 'number', at: [0, 1, 3, 2], title: 'Flow', channel: 'boiler-house/device-${pump}/flow-1', digits: 1 },
    { kind: 'gauge', at: [3, 1, 3, 4], title: 'Pressure', channel: 'boiler-house/device-${pump}/pressure-1', min: 0, max: 100 },
    { kind: 'level', at: [6, 1, 2, 4], title: 'Level', channel: 'boiler-house/device-${pump}/level-1', min: 0, max: 100 },
    { kind: 'lamp', at: [8, 1, 2, 2], title: 'Motor', channel: 'boiler-house/device-${pump}/running-1', states: [{ value: true, text: 'Running', tone: 'good' }, { value: false, text: 'Stopped', tone: 'warning' }] },
    { kind: 'button', at: [10, 1, 2, 3], title: 'Motor', channel: 'boiler-house/device-${pump}/running-1', value: false, text: 'Stop', verify: true },
    { kind: 'setpoint', at: [0, 3, 3, 3], title: 'Speed', channel: 'boiler-house/device-${pump}/speed-setpoint-1' },
    { kind: 'trend', at: [0, 6, 6, 6], title: 'Temperatures', channels: ['boiler-house/device-${pump}/temperature-1', 'boiler-house/device-${pump}/pressure-1'], span: '10min' },
    { kind: 'bars', at: [6, 5, 6, 4], title: 'Levels', channels: ['boiler-house/device-01/level-1', 'boiler-house/device-02/level-1', 'boiler-house/device-03/level-1'], min: 0, max: 100, digits: 1 },
    { kind: 'table', at: [6, 9, 6, 5], title: 'Pump', pattern: 'boiler-house/device-${pump}' },
    { kind: 'alarms', at: [0, 12, 6, 4], pattern: 'boiler-house' },
    { kind: 'picture', at: [0, 16, 12, 8], title: 'Scheme', picture: 'scheme', values: [
      { channel: 'boiler-house/device-${pump}/temperature-1', x: 20, y: 40, label: 'T' }, { channel: 'boiler-house/device-${pump}/flow-1', x: 60, y: 40, digits: 1, size: 6 }] },
  ],
};
const wall = { name: 'wall', title: 'Wall', widgets: [{ kind: 'number', at: [0, 0, 4, 3], channel: `${device}/flow-1` }] };
const scheme = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 400 160"><rect x="20" y="40" width="120" height="90" rx="8" fill="#dfe7ee" stroke="#55606b" stroke-width="3"></rect>' +
  '<path d="M140 85H260" stroke="#55606b" stroke-width="6"></path><circle cx="290" cy="85" r="30" fill="#dfe7ee" stroke="#55606b" stroke-width="3"></circle></svg>';

// Sixty widgets for the bench: every kind but the large ones, over the channels of several devices.
function sixty() {
  const widgets = [];
  for (let n = 0; n < 60; n++) {
    const channel = (name) => `boiler-house/device-${String(1 + (n % 20)).padStart(2, '0')}/${name}-${1 + Math.floor(n / 20)}`;
    const at = [2 * (n % 6), 3 * Math.floor(n / 6), 2, 3];
    const kinds = [
      { kind: 'number', channel: channel('flow'), digits: 2 }, { kind: 'gauge', channel: channel('pressure'), min: 0, max: 100 },
      { kind: 'level', channel: channel('level'), min: 0, max: 100 }, { kind: 'lamp', channel: channel('running'), states: [{ value: 1, text: 'Running' }] },
      { kind: 'number', channel: channel('temperature') }, { kind: 'trend', channels: [channel('flow')], span: '1min' },
    ];
    widgets.push({ ...kinds[n % kinds.length], at });
  }
  return { name: 'sixty', title: 'Sixty', widgets };
}

export function mockDashboards() {
  const now = Date.now();
  const saved = new Map([pumps, wall, sixty()].map((each) => [each.name, { name: each.name, title: each.title, version: 1, saved_by: 'erik', saved_ms: now, text: JSON.stringify(each) }]));
  const pictures = new Map([['scheme', { name: 'scheme', version: 1, type: 'svg', width: 400, height: 160, bytes: scheme.length, saved_by: 'erik', saved_ms: now }]]);
  const headOf = ({ text, ...head }) => head;
  const state = { saved, pictures, faults: [] };
  const missing = [404, { error: 'there is no dashboard of this name', hint: '' }];
  state.get = {
    '/api/dashboards': () => [200, { dashboards: [...saved.values()].map(headOf) }],
    '/api/dashboard': (url) => {
      const found = saved.get(url.searchParams.get('name'));
      if (!found) return missing;
      const { title, ...rest } = found;
      return [200, rest];
    },
    '/api/pictures': () => [200, { pictures: [...pictures.values()] }],
    '/api/picture': () => ({ svg: scheme }),
  };
  state.post = {
    '/api/dashboards/check': () => [200, { faults: state.faults }],
    '/api/dashboards/save': ({ user }, { text, base }) => {
      const { name, title } = JSON.parse(text), version = saved.get(name)?.version ?? 0;
      if (version !== base) return [409, { error: `${saved.get(name)?.saved_by} has saved version ${version} of this dashboard`, hint: 'load it, repeat your change and save again' }];
      saved.set(name, { name, title, version: version + 1, saved_by: user, saved_ms: Date.now(), text });
      return [200, headOf(saved.get(name))];
    },
    '/api/dashboards/delete': (_, { name }) => (saved.delete(name) ? [200, {}] : missing),
    '/api/pictures/save': ({ user }, { name, data }) => {
      const picture = { name, version: 1, type: 'svg', width: 10, height: 10, bytes: data.length, saved_by: user, saved_ms: Date.now() };
      pictures.set(name, picture);
      return [200, { ...picture, removed: ['script'] }];
    },
    '/api/pictures/delete': (_, { name }) => (pictures.delete(name) ? [200, {}] : missing),
  };
  return state;
}
