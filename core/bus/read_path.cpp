#include "core/bus/read_path.hpp"

#include <algorithm>

#include "core/base/message_text.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kNowhere = ~std::size_t{0};

// Points and ranges of a block are both in order, so the range is at or soon after `hint`.
std::size_t find_range(const Block& block, std::size_t responded, const Range& range,
                       std::size_t hint) {
  for (std::size_t tried = 0; tried < responded; ++tried) {
    const std::size_t i = (hint + tried) % responded;
    const Range& whole = block.ranges[i];
    if (whole.area == range.area && range.first >= whole.first && range.end() <= whole.end())
      return i;
  }
  return kNowhere;
}

Block part_of(const Block& block, std::vector<PointIndex> points) {
  return {block.device, block.ranges, std::move(points), block.cost};
}

std::uint32_t items_of(const Block& block) {
  std::uint32_t items = 0;
  for (const Range& range : block.ranges) items += range.count;
  return items;
}

}  // namespace

ReadPath::ReadPath(const BusSetup& setup, ChannelTable& channels)
    : setup_(setup), channels_(channels), map_(map_points(setup.spec())) {
  std::vector<const Protocol*> protocols;
  std::vector<std::size_t> areas;
  for (DeviceIndex device = 0; device < setup_.devices(); ++device) {
    protocols.push_back(&setup_.protocol(device));
    areas.push_back(setup_.protocol(device).areas().size());
    learned_.emplace_back().areas.resize(areas.back());
  }
  planned_times_ = PlannedTimes(areas, kAssumedResponseTime);
  scheduler_ =
      make_scheduler(schedule_input(setup_.spec(), protocols, map_.points, kAssumedResponseTime),
                     setup_.spec().planner);
}

std::variant<ReadPath::Read, Rest> ReadPath::next(Instant now, const Gate& gate) {
  for (int held = 0;; ++held) {
    Decision decision = scheduler_->next(now);
    if (const auto* rest = std::get_if<Rest>(&decision)) return *rest;
    Read read{std::move(std::get<Block>(decision)), {}};
    read.request = ReadRequest{read.block.ranges};
    const Instant from = gate(read.block.device, read.request);
    if (from <= now || lengthen(read, now, gate)) return read;
    hold(read.block, from, now);
    if (held == kMaxHeldAtOnce) return Rest{from};
  }
}

bool ReadPath::due(Instant now) { return std::holds_alternative<Block>(scheduler_->next(now)); }

// Lengthens the read, so that its response differs from pending ones and settles all debts.
bool ReadPath::lengthen(Read& read, Instant now, const Gate& gate) const {
  const DeviceIndex device = read.block.device;
  auto& request = std::get<ReadRequest>(read.request);
  if (learned_[device].refused_longer || request.ranges.size() != 1) return false;
  const Range block = request.ranges[0];
  if (!learned_[device].areas[block.area].gaps().empty()) return false;
  const Area& area = setup_.area(device, block.area);
  if (area.window) return false;
  const auto max_gap = setup_.device(device).max_gap;
  for (std::uint32_t times = 1; times <= kMostLonger; ++times) {
    if (max_gap && times * area.alignment > *max_gap) break;
    Range& longer = request.ranges[0];
    longer.count = block.count + times * area.alignment;
    if (longer.end() > area.items || !in_one_bank(area, longer.first, longer.end())) break;
    if (!setup_.protocol(device).size(read.request)) break;
    if (gate(device, read.request) > now) continue;
    read.longer = true;
    return true;
  }
  request.ranges[0] = block;
  return false;
}

void ReadPath::hold(const Block& block, Instant until, Instant now) {
  scheduler_->failed(block, now, until);
  std::erase_if(held_, [&](const Held& each) { return each.until <= now; });
  held_.push_back({block, until});
}

void ReadPath::release_held(Instant now, const Gate& gate) {
  std::erase_if(held_, [&](const Held& each) {
    if (each.until <= now) return true;
    if (gate(each.block.device, ReadRequest{each.block.ranges}) > now) return false;
    scheduler_->failed(each.block, now, now);
    return true;
  });
}

namespace {

bool is_absent(const Range& own, const RangeReply& reply) {
  return std::ranges::any_of(reply.absent, [&](const Range& part) {
    return part.first < own.end() && part.end() > own.first;
  });
}

}  // namespace

void ReadPath::responded(const Block& block, const Reply& reply, Instant acquired, Instant now,
                         ActionSink& sink) {
  learn_blocks(block, reply, now);
  std::vector<Sample> samples;
  std::vector<PointIndex> good;
  // Refused points by range, so that the search for a bad point stays within its range.
  std::vector<RefusedPart> bad;
  samples.reserve(block.points.size());
  good.reserve(block.points.size());
  const std::size_t responded = std::min(block.ranges.size(), reply.size());
  std::size_t at = 0;
  for (const PointIndex point : block.points) {
    const std::size_t found = find_range(block, responded, map_.points[point].range, at);
    if (found != kNowhere) at = found;
    if (found == kNowhere || reply[found].cause != Cause::kNone) {
      if (bad.empty() || bad.back().range != found) bad.push_back({found, {}});
      bad.back().points.push_back(point);
      continue;
    }
    good.push_back(point);
    accept(point, block.ranges[found], reply[found], acquired, samples, sink);
  }
  if (sink.tracing())
    sink.trace(block.device, "read " + text(block.points.front()) + ".., " +
                                 counted(items_of(block), "item", "items") + ", " +
                                 counted(samples.size(), "sample", "samples"));
  sink.publish(std::move(samples));
  if (!good.empty()) {
    others_responded(block.device);
    const Block read = part_of(block, std::move(good));
    if (setup_.spec().in_flight > 1)
      scheduler_->confirmed(read, acquired);
    else
      scheduler_->acquired(read, acquired);
  }
  std::vector<Sample> bad_samples;
  for (RefusedPart& part : bad) {
    const RangeReply response = part.range == kNowhere ? RangeReply{} : reply[part.range];
    if (response.cause == Cause::kDeviceBusy) {
      busy(part_of(block, std::move(part.points)), response.device_code, now, sink);
      continue;
    }
    refused(part_of(block, std::move(part.points)), response.cause, response.device_code, now,
            bad_samples, sink);
  }
  sink.publish(std::move(bad_samples));
}

// `reply`: of the range `responded`, which contains the point.
void ReadPath::accept(PointIndex point, const Range& responded, const RangeReply& reply,
                      Instant acquired, std::vector<Sample>& samples, ActionSink& sink) {
  const Point& read = map_.points[point];
  const unsigned bits = setup_.area(read.device, read.range.area).item_bits;
  const ByteView own = ByteView(reply.items)
                           .subspan(image_bytes(bits, read.range.first - responded.first),
                                    image_bytes(bits, read.range.count));
  const bool absent = is_absent(read.range, reply);
  Learned& learned = learned_[read.device];
  learned.doubted.erase(point);
  learned.busy.erase(point);
  learned.searched.erase(point);
  if (learned.refused.erase(point) + learned.busy_alone.erase(point) > 0)
    sink.notice(Notice::Kind::kAddressRefused, read.device, Cause::kNone,
                text(point) + " is readable again");
  for (const ChannelIndex channel : map_.channels_of[point]) {
    if (absent)
      channels_.no_value(channel, Cause::kNotAvailable, acquired, samples);
    else
      channels_.acquired(channel, bits, own, acquired, samples);
  }
}

void ReadPath::learn_blocks(const Block& block, const Reply& reply, Instant now) {
  for (std::size_t i = 0; i < block.ranges.size() && i < reply.size(); ++i) {
    if (reply[i].cause != Cause::kNone) continue;
    const Range& range = block.ranges[i];
    BlockLearning& blocks = learned_[block.device].areas[range.area];
    const bool forgotten = blocks.expire(now);
    if (blocks.read(range, now) || forgotten)
      scheduler_->set_longest(block.device, range.area, blocks.longest());
  }
}

void ReadPath::learn(DeviceIndex device, AreaIndex area, Duration response_time) {
  planned_times_.responded(device, area, response_time, *scheduler_);
}

void ReadPath::save_silence(Duration saved) { planned_times_.save(saved, *scheduler_); }

void ReadPath::inherit(ChannelIndex channel, Instant acquired) {
  if (channel >= map_.point_of.size() || acquired == kLongAgo) return;
  if (const auto point = map_.point_of[channel]) scheduler_->inherit(*point, acquired);
}

void ReadPath::inherit(DeviceIndex device, const DeviceReport& learned, Instant now) {
  const auto areas = setup_.protocol(device).areas();
  for (const AreaReport& of_area : learned.areas) {
    for (AreaIndex area = 0; area < areas.size(); ++area) {
      if (areas[area].name != of_area.area) continue;
      if (of_area.response_time > Duration::zero()) learn(device, area, of_area.response_time);
      if (of_area.longest_block != 0) scheduler_->set_longest(device, area, of_area.longest_block);
    }
  }
  for (PointIndex point = 0; point < map_.points.size(); ++point) {
    if (map_.points[point].device != device) continue;
    if (std::ranges::find(learned.refused, text(point)) == learned.refused.end()) continue;
    Block alone;
    alone.device = device;
    alone.points = {point};
    alone.ranges = {map_.points[point].range};
    for (const PointIndex bad : scheduler_->refused(alone, now, kForgetRefused)) {
      learned_[device].refused.emplace(bad, std::uint16_t{0});
      for (const ChannelIndex channel : map_.channels_of[bad])
        channels_.failing(channel, Cause::kDeviceError, now);
    }
  }
}

void ReadPath::failed(const Block& block, bool longer, Cause cause, std::uint16_t code, Instant now,
                      ActionSink& sink) {
  if (cause == Cause::kDeviceBusy) return busy(block, code, now, sink);
  if (cause != Cause::kDeviceError && cause != Cause::kUnsupported) {
    for (const PointIndex point : block.points) {
      for (const ChannelIndex channel : map_.channels_of[point])
        channels_.failing(channel, cause, now);
    }
    return scheduler_->failed(block, now, now);
  }
  if (longer) {  // the refusal may concern only the added items
    learned_[block.device].refused_longer = true;
    return scheduler_->failed(block, now, now);
  }
  std::vector<Sample> samples;
  refused(block, cause, code, now, samples, sink);
  sink.publish(std::move(samples));
}

// As with refused addresses, the scheduler halves a block until the busy points stand alone.
void ReadPath::busy(const Block& block, std::uint16_t code, Instant now, ActionSink& sink) {
  Duration longest = kLongestBusyPause;
  for (const PointIndex point : block.points) {
    longest = std::min(longest, map_.points[point].refresh);
    for (const ChannelIndex channel : map_.channels_of[point])
      channels_.failing(channel, Cause::kDeviceBusy, now, code);
  }
  Learned& learned = learned_[block.device];
  const PointIndex first = block.points.front();
  const bool alone = block.points.size() == 1 && learned.searched.contains(first);
  Busy& busy = learned.busy[first];
  busy.pause = std::min(busy.pause == Duration::zero() ? kFirstBusyPause : busy.pause * 2,
                        alone ? kLongestBusyPause : longest);
  ++busy.times;
  const bool search =
      block.points.size() > 1 &&
      (learned.searched.contains(first) || (busy.times >= kBusyToSearch && busy.others_responded));
  if (search) {
    learned.searched.insert(block.points.begin(), block.points.end());
    (void)scheduler_->refused(block, now, kForgetRefused);
  } else if (alone) {
    (void)scheduler_->refused(block, now, busy.pause);
    if (learned.busy_alone.insert(first).second)
      sink.notice(Notice::Kind::kAddressRefused, block.device, Cause::kDeviceBusy,
                  text(first) + " cannot be read at the moment" +
                      device_code_note(setup_.protocol(block.device).traits().codes, code) +
                      ", others can; it is requested alone, ever more rarely");
  } else {
    scheduler_->failed(block, now, now + busy.pause);
  }
}

void ReadPath::others_responded(DeviceIndex device) {
  for (auto& [first, busy] : learned_[device].busy) busy.others_responded = true;
}

// The scheduler halves the block until bad points are isolated; those are reported immediately.
void ReadPath::refused(const Block& block, Cause cause, std::uint16_t code, Instant now,
                       std::vector<Sample>& samples, ActionSink& sink) {
  if (doubts(block)) return scheduler_->failed(block, now, now);
  std::vector<BlockLearning>& areas = learned_[block.device].areas;
  if (block.ranges.size() == 1 && block.points.size() > 1) {
    std::vector<Range> wanted;
    for (const PointIndex point : block.points) wanted.push_back(map_.points[point].range);
    areas[block.ranges[0].area].refused(block.ranges[0], std::move(wanted));
  }
  for (const PointIndex point : scheduler_->refused(block, now, kForgetRefused))
    point_refused(point, cause, code, now, samples, sink);
}

bool ReadPath::doubts(const Block& block) {
  if (block.points.size() != 1) return false;
  const PointIndex point = block.points.front();
  const bool was_read = std::ranges::any_of(
      map_.channels_of[point], [&](ChannelIndex channel) { return channels_.was_read(channel); });
  return was_read && learned_[block.device].doubted.insert(point).second;
}

void ReadPath::point_refused(PointIndex point, Cause cause, std::uint16_t code, Instant now,
                             std::vector<Sample>& samples, ActionSink& sink) {
  const DeviceIndex device = map_.points[point].device;
  const Range& range = map_.points[point].range;
  Learned& learned = learned_[device];
  learned.areas[range.area].bad(range);
  const bool is_new = learned.refused.emplace(point, code).second;
  for (const ChannelIndex channel : map_.channels_of[point])
    channels_.refused(channel, cause, code, now, samples);
  if (!is_new) return;
  const Traits& traits = setup_.protocol(device).traits();
  sink.notice(Notice::Kind::kAddressRefused, device, cause,
              text(point) + " is refused" + device_code_note(traits.codes, code) +
                  "; asked again in " + to_text(kForgetRefused));
}

void ReadPath::forget(DeviceIndex device) {
  planned_times_.forget(device);
  Learned& learned = learned_[device];
  learned.refused_longer = false;
  learned.doubted.clear();
  learned.searched.clear();
  for (AreaIndex area = 0; area < learned.areas.size(); ++area) {
    if (learned.areas[area].forget()) scheduler_->set_longest(device, area, 0);
  }
}

void ReadPath::set_interest(ChannelIndex channel, std::optional<Duration> refresh, Instant now,
                            ActionSink& sink) {
  if (channel >= channels_.size() || !channels_.spec(channel).on_interest) return;
  std::vector<Sample> samples;
  if (!refresh) channels_.interest_ended(channel, samples);
  sink.publish(std::move(samples));  // before the channel moves to the writer without a promise
  channels_.set_refresh(channel, refresh, now);
  sink.push(Promise{channel, refresh});
  if (map_.point_of[channel]) update_point(*map_.point_of[channel], now);
}

void ReadPath::update_point(PointIndex index, Instant now) {
  Point& point = map_.points[index];
  point.mode = Mode::kOnDemand;
  for (const ChannelIndex channel : map_.channels_of[index])
    ask_for(point, channels_.spec(channel), channels_.refresh(channel));
  scheduler_->set_point(index, point, now);
}

std::shared_ptr<PlanDraft> ReadPath::draft() {
  // Keeps the protocols alive, from which the draft requests sizes.
  struct Kept {
    std::vector<std::shared_ptr<const Protocol>> protocols;
    std::unique_ptr<PlanDraft> draft;
  };
  auto draft = scheduler_->draft();
  if (!draft) return nullptr;
  auto kept = std::make_shared<Kept>(Kept{setup_.protocols(), std::move(draft)});
  return {kept, kept->draft.get()};
}

const std::string& ReadPath::text(PointIndex point) const {
  return channels_.spec(map_.channels_of[point].front()).at;
}

std::string ReadPath::channel_names(const Block& block, std::size_t most) const {
  std::string names;
  std::size_t named = 0, all = 0;
  for (const PointIndex point : block.points) {
    const auto& channels = map_.channels_of[point];
    all += channels.size();
    for (std::size_t i = 0; i < channels.size() && named < most; ++i, ++named)
      names += (named == 0 ? "" : ", ") + channels_.spec(channels[i]).name;
  }
  return all > named ? names + ", +" + std::to_string(all - named) : names;
}

std::vector<std::optional<Range>> ReadPath::first_ranges() const {
  std::vector<std::optional<Range>> ranges(setup_.devices());
  for (const Point& point : map_.points) {
    if (auto& range = ranges[point.device]; !range) range = point.range;
  }
  return ranges;
}

PlanReport ReadPath::plan_report() const {
  std::vector<std::string_view> names;  // by ChannelIndex
  for (const DeviceSpec& device : setup_.spec().devices) {
    for (const ChannelSpec& channel : device.channels) names.push_back(channel.name);
  }
  return report_of(scheduler_->plan(), map_.points,
                   {.device = [this](DeviceIndex device) -> std::string_view {
                      return setup_.device(device).name;
                    },
                    .area = [this](DeviceIndex device, AreaIndex area) -> std::string_view {
                      return setup_.area(device, area).name;
                    },
                    .channels =
                        [&](PointIndex point) {
                          std::vector<std::string> channels;
                          for (const ChannelIndex channel : map_.channels_of[point])
                            channels.emplace_back(names[channel]);
                          return channels;
                        }});
}

void ReadPath::describe(DeviceIndex device, DeviceReport& report) const {
  const Learned& learned = learned_[device];
  for (AreaReport& of_area : report.areas) {
    AreaIndex area = 0;
    while (setup_.area(device, area).name != of_area.area) ++area;
    const BlockLearning& blocks = learned.areas[area];
    of_area.largest_block = blocks.largest_read();
    of_area.longest_block = blocks.longest();
    for (const Range& gap : blocks.gaps()) {
      if (report.refused_gaps.size() == kMaxRefusedListed) break;
      report.refused_gaps.push_back(setup_.text(device, gap));
    }
  }
  for (const auto& [point, code] : learned.refused) {
    if (report.refused.size() == kMaxRefusedListed) break;
    report.refused.push_back(text(point));
  }
}

}  // namespace fieldcast
