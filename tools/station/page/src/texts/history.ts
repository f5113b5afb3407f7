export const en = {
  'history.title': 'History', 'history.add': 'Add a channel', 'history.add-hint': 'bus/device/channel', 'history.from': 'From', 'history.to': 'To',
  'history.show': 'Show', 'history.back': 'Zoom out', 'history.csv': 'CSV', 'history.none': 'Choose up to eight channels.',
  'history.none-hint': 'Type a part of a name and take one of the list. The address of this page can be sent.',
  'history.no-store': 'This station keeps no history.', 'history.no-store-hint': 'Give it a store in its configuration, then it records.',
  'history.remove': 'Remove {path}', 'history.full': 'Eight channels are the most.', 'history.no-data': 'no data',
  'history.points': '{n} points of {width}', 'history.raw': '{n} samples', 'history.min': 'Min', 'history.average': 'Average', 'history.max': 'Max',
  'history.bad': 'Bad', 'history.cursor': 'At {time}', 'history.channel': 'Channel', 'history.chart': 'Trend of {n} channels', 'history.resolution': 'Resolution',
  'history.drag': 'Drag across the trend to zoom in.', 'history.value': 'Value', 'history.unit': 'Unit', 'history.text': 'A text has no trend: see its CSV.',
};

export const zh: Record<keyof typeof en, string> = {
  'history.title': '历史', 'history.add': '添加通道', 'history.add-hint': '总线/设备/通道', 'history.from': '从', 'history.to': '到',
  'history.show': '显示', 'history.back': '缩小', 'history.csv': 'CSV', 'history.none': '最多选择八个通道。',
  'history.none-hint': '输入名称的一部分，再从列表中选择。本页地址可以转发。',
  'history.no-store': '此监控站不保存历史。', 'history.no-store-hint': '在其配置中设置存储后即开始记录。',
  'history.remove': '移除 {path}', 'history.full': '最多八个通道。', 'history.no-data': '无数据',
  'history.points': '{n} 个点，每点 {width}', 'history.raw': '{n} 个样本', 'history.min': '最小', 'history.average': '平均', 'history.max': '最大',
  'history.bad': '异常', 'history.cursor': '时刻 {time}', 'history.channel': '通道', 'history.chart': '{n} 个通道的趋势', 'history.resolution': '分辨率',
  'history.drag': '在趋势图上拖动即可放大。', 'history.value': '数值', 'history.unit': '单位', 'history.text': '文本没有趋势：请查看其 CSV。',
};
