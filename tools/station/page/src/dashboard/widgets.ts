// The kinds of widgets, one row each. The station's table (dashboard_format.json) has their properties.

import type { Host, WidgetView } from './widget';
import type { Widget } from './document';
import { AlarmsWidget } from './widgets/alarms';
import { BarsWidget } from './widgets/bars';
import { ButtonWidget } from './widgets/button';
import { GaugeWidget } from './widgets/gauge';
import { LampWidget } from './widgets/lamp';
import { LevelWidget } from './widgets/level';
import { NumberWidget } from './widgets/number';
import { PictureWidget } from './widgets/picture';
import { SetpointWidget } from './widgets/setpoint';
import { TableWidget } from './widgets/table';
import { TextWidget } from './widgets/text';
import { TrendWidget } from './widgets/trend';

export const widgets: Readonly<Record<string, new (host: Host, widget: Widget) => WidgetView>> = {
  number: NumberWidget,
  gauge: GaugeWidget,
  level: LevelWidget,
  lamp: LampWidget,
  trend: TrendWidget,
  bars: BarsWidget,
  table: TableWidget,
  alarms: AlarmsWidget,
  button: ButtonWidget,
  setpoint: SetpointWidget,
  picture: PictureWidget,
  text: TextWidget,
};
