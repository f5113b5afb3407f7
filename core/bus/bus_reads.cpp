// Reading: points from channels, samples from blocks, and what refusals and failures of blocks
// mean.
#include <algorithm>

#include "core/bus/bus_state.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kNowhere = ~std::size_t{0};

// Which of the block's ranges holds `range`; points and ranges of a block are both in order, so it
// is at `hint` or soon behind.
std::size_t find_range(const Block& block, std::size_t answered, const Range& range,
                       std::size_t hint) {
  for (std::size_t tried = 0; tried < answered; ++tried) {
    const std::size_t i = (hint + tried) % answered;
    const Range& whole = block.ranges[i];
    if (whole.area == range.area && range.first >= whole.first && range.end() <= whole.end())
      return i;
  }
  return kNowhere;
}

Block part_of(const Block& block, std::vector<PointIndex> points) {
  return {block.device, block.ranges, std::move(points), block.cost};
}

}  // namespace

void BusEngine::State::make_scheduler() {
  map = map_points(spec);
  std::vector<const Protocol*> protocols;
  std::vector<std::size_t> areas;
  for (DeviceIndex device = 0; device < setup.devices(); ++device) {
    protocols.push_back(&setup.protocol(device));
    areas.push_back(setup.protocol(device).areas().size());
  }
  planned_times = PlannedTimes(areas, kAssumedAnswerTime);
  scheduler = fieldcast::make_scheduler(
      schedule_input(spec, protocols, map.points, kAssumedAnswerTime), spec.planner);
  overload.emplace(scheduler->stretch());
}

// A point is as urgent as the most urgent of its channels at present.
void BusEngine::State::update_point(PointIndex index, Instant now) {
  Point& point = map.points[index];
  point.mode = Mode::kOnDemand;
  for (const ChannelIndex c : map.channels_of[index])
    ask_for(point, channels.spec(c), channels.refresh(c));
  scheduler->set_point(index, point.refresh, point.mode, now);
}

void BusEngine::State::set_interest(ChannelIndex channel, std::optional<Duration> wish, Instant now,
                                    Actions& actions) {
  if (channel >= channels.size() || !channels.spec(channel).on_interest) return;
  std::vector<Sample> out;
  if (!wish) channels.interest_ended(channel, out);
  samples += out.size();
  if (!out.empty())
    actions.push_back(
        Publish{std::move(out)});  // before the channel moves to the writer without a promise
  channels.set_refresh(channel, wish, now);
  actions.push_back(Promise{channel, wish});
  if (map.point_of[channel]) update_point(*map.point_of[channel], now);
}

std::string BusEngine::State::point_text(PointIndex point) const {
  return channels.spec(map.channels_of[point].front()).at;
}

void BusEngine::State::block_read(const Flight& read, const Reply& reply, Instant acquired,
                                  Instant now, Actions& actions) {
  DeviceRuntime& device = devices[read.device];
  ActionSink sink(setup, samples, actions);
  std::vector<Sample> out;
  std::vector<PointIndex> good;
  // What the device refused: each range for itself, so that the search for what is bad in it stays
  // within it.
  struct Refused {
    std::size_t range;
    std::vector<PointIndex> points;
  };
  std::vector<Refused> bad;
  std::uint32_t items_read = 0;
  for (const Range& range : read.block.ranges) items_read += range.count;
  learn_blocks(read, reply, now);

  good.reserve(read.block.points.size());
  out.reserve(read.block.points.size());
  const std::size_t answered = std::min(read.block.ranges.size(), reply.size());
  std::size_t at = 0;
  for (const PointIndex p : read.block.points) {
    const Range& range = map.points[p].range;
    const Area& area = setup.area(read.device, range.area);
    const std::size_t found = find_range(read.block, answered, range, at);
    if (found != kNowhere) at = found;
    if (found == kNowhere || reply[found].cause != Cause::kNone) {
      if (bad.empty() || bad.back().range != found) bad.push_back({found, {}});
      bad.back().points.push_back(p);
      continue;
    }
    const ByteView items =
        ByteView(reply[found].items)
            .subspan(image_bytes(area.item_bits, range.first - read.block.ranges[found].first),
                     image_bytes(area.item_bits, range.count));
    good.push_back(p);
    if (device.refused.erase(p))
      sink.notice(Notice::Kind::kAddressRefused, read.device, Cause::kNone,
                  point_text(p) + " is answered again");
    for (const ChannelIndex c : map.channels_of[p])
      channels.acquired(c, area.item_bits, items, acquired, out);
  }
  samples += out.size();
  if (trace)
    sink.push(Traced{setup.device(read.device).name,
                     "read " + point_text(read.block.points.front()) + ".., " +
                         std::to_string(items_read) + " items, " + std::to_string(out.size()) +
                         " samples"});
  if (!out.empty()) actions.push_back(Publish{std::move(out)});
  if (!good.empty()) scheduler->acquired(part_of(read.block, std::move(good)), acquired);
  std::vector<Sample> refused;
  for (Refused& part : bad) {
    const RangeReply answer = part.range == kNowhere ? RangeReply{} : reply[part.range];
    block_refused(part_of(read.block, std::move(part.points)), answer.cause, answer.device_code,
                  now, refused, sink);
  }
  samples += refused.size();
  if (!refused.empty()) actions.push_back(Publish{std::move(refused)});
}

// A range that was read or refused says something of how long a block the device accepts, and which
// gaps.
void BusEngine::State::learn_blocks(const Flight& read, const Reply& reply, Instant now) {
  for (std::size_t i = 0; i < read.block.ranges.size() && i < reply.size(); ++i) {
    if (reply[i].cause != Cause::kNone) continue;
    const Range& range = read.block.ranges[i];
    BlockLearning& blocks = devices[read.device].areas[range.area];
    const bool forgotten = blocks.expire(now);
    if (blocks.read(range, now) || forgotten)
      scheduler->set_longest(read.device, range.area, blocks.longest());
  }
}

void BusEngine::State::block_failed(const Flight& read, Cause cause, std::uint16_t code,
                                    Instant now, Actions& actions) {
  if (cause == Cause::kDeviceError || cause == Cause::kUnsupported) {
    if (read.longer) {  // that says nothing of the block itself
      devices[read.device].refused_longer = true;
      return scheduler->failed(read.block, now, now);
    }
    ActionSink sink(setup, samples, actions);
    std::vector<Sample> out;
    block_refused(read.block, cause, code, now, out, sink);
    samples += out.size();
    if (!out.empty()) actions.push_back(Publish{std::move(out)});
    return;
  }
  if (cause == Cause::kDeviceBusy) monitor->busy(read.device, now);
  for (const PointIndex p : read.block.points) {
    for (const ChannelIndex c : map.channels_of[p]) channels.failing(c, cause, now);
  }
  scheduler->failed(read.block, now, now);
}

// The scheduler halves the block until the bad points stand alone; those are told at once.
void BusEngine::State::block_refused(const Block& block, Cause cause, std::uint16_t code,
                                     Instant now, std::vector<Sample>& out, ActionSink& sink) {
  DeviceRuntime& device = devices[block.device];
  if (block.ranges.size() == 1 && block.points.size() > 1) {
    std::vector<Range> wanted;
    for (const PointIndex p : block.points) wanted.push_back(map.points[p].range);
    device.areas[block.ranges[0].area].refused(block.ranges[0], std::move(wanted));
  }
  for (const PointIndex p : scheduler->refused(block, now, kForgetRefused)) {
    device.areas[map.points[p].range.area].bad(map.points[p].range);
    const bool news = device.refused.emplace(p, code).second;
    for (const ChannelIndex c : map.channels_of[p]) channels.refused(c, cause, code, now, out);
    if (news)
      sink.notice(Notice::Kind::kAddressRefused, block.device, cause,
                  point_text(p) + " is refused" +
                      device_code_note(setup.protocol(block.device).traits().codes, code) +
                      "; asked again in " + to_text(kForgetRefused));
  }
}

// A read that is longer than its block by some items can be told apart from what is owed, and its
// answer ends all debts of the device: nothing need wait for their time.
bool BusEngine::State::make_distinct(Flight& read, Instant now) const {
  constexpr std::uint32_t kMostLonger = 4;  // times the alignment
  const DeviceRuntime& device = devices[read.device];
  auto& request = std::get<ReadRequest>(read.request);
  if (device.refused_longer || request.ranges.size() != 1) return false;
  if (!device.areas[request.ranges[0].area].gaps().empty()) return false;
  const Area& area = setup.area(read.device, request.ranges[0].area);
  if (area.window) return false;
  const Range block = request.ranges[0];
  for (std::uint32_t times = 1; times <= kMostLonger; ++times) {
    if (setup.device(read.device).max_gap &&
        times * area.alignment > *setup.device(read.device).max_gap)
      break;
    Range& longer = request.ranges[0];
    longer.count = block.count + times * area.alignment;
    if (longer.end() > area.items || !in_one_bank(area, longer.first, longer.end())) break;
    if (!setup.protocol(read.device).size(read.request)) break;
    if (late.sendable_from(read.device, read.request, LateAnswers::Purpose::kRead) > now) continue;
    read.longer = true;
    return true;
  }
  request.ranges[0] = block;
  return false;
}

void BusEngine::State::hold(const Block& block, Instant until, Instant now) {
  scheduler->failed(block, now, until);
  std::erase_if(held, [&](const Held& each) { return each.until <= now; });
  held.push_back({block, until});
}

// Debts have ended: what waited for that is due.
void BusEngine::State::release_held(Instant now) {
  late.expire(now);
  std::erase_if(held, [&](const Held& each) {
    if (each.until <= now) return true;
    const ReadRequest read{each.block.ranges};
    if (late.sendable_from(each.block.device, read, LateAnswers::Purpose::kRead) > now)
      return false;
    scheduler->failed(each.block, now, now);
    return true;
  });
}

}  // namespace fieldcast
