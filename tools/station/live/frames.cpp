#include "tools/station/live/frames.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <utility>
#include <variant>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::web {

bool LiveSubscription::add(const Pattern& pattern) {
  const bool had_everything = key_ == kEverything;
  const bool is_new = patterns_.emplace(pattern.text(), pattern).second;
  make_key();
  return is_new && !had_everything;
}

bool LiveSubscription::remove(const Pattern& pattern) {
  const bool found = patterns_.erase(pattern.text()) != 0;
  make_key();
  return found;
}

bool LiveSubscription::matches(const StationChannel& channel) const {
  if (key_ == kEverything) return true;
  return std::any_of(patterns_.begin(), patterns_.end(), [&](const auto& entry) {
    return entry.second.matches(channel.bus, channel.device, channel.channel);
  });
}

void LiveSubscription::make_key() {
  if (patterns_.contains(kEverything)) {
    key_ = kEverything;
    return;
  }
  key_.clear();
  for (const auto& [text, pattern] : patterns_) key_ += text + '\n';
}

bool ClientInterests::add(const std::string& pattern, Duration refresh) {
  if (wished_.size() >= kMaxPatterns && !wished_.contains(pattern)) return false;
  std::multiset<Duration>& wishes = wished_[pattern];
  const bool shorter = wishes.empty() || refresh < *wishes.begin();
  wishes.insert(refresh);
  if (shorter) declare_(pattern, refresh);
  return true;
}

void ClientInterests::remove(const std::string& pattern, Duration refresh) {
  const auto found = wished_.find(pattern);
  std::multiset<Duration>& wishes = found->second;
  const Duration before = *wishes.begin();
  wishes.erase(wishes.find(refresh));
  if (wishes.empty()) {
    wished_.erase(found);
    declare_(pattern, Duration{});
  } else if (*wishes.begin() != before) {
    declare_(pattern, *wishes.begin());
  }
}

namespace {

static_assert(std::endian::native == std::endian::little, "frames are copied as they lie");

constexpr std::int64_t kMillisecond = 1'000'000;  // nanoseconds

// The resolution of browser clocks.
std::int64_t acquired_ms(const LiveChannel& channel) {
  return channel.last.acquired_at.nanoseconds / kMillisecond;
}

double number_of(const LiveValue& last) {
  if (last.acquired_at.nanoseconds == 0 || needs_text(last.value))
    return std::numeric_limits<double>::quiet_NaN();
  if (const bool* const flag = std::get_if<bool>(&last.value)) return *flag ? 1 : 0;
  return *as_number(last.value);
}

template <class Number>
void put(std::string& out, std::size_t at, Number number) {
  std::memcpy(out.data() + at, &number, sizeof number);
}

}  // namespace

bool needs_text(const Value& value) {
  if (const auto* whole = std::get_if<std::uint64_t>(&value)) return *whole > kMaxExact;
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return *integer > static_cast<std::int64_t>(kMaxExact) ||
           *integer < -static_cast<std::int64_t>(kMaxExact);
  return std::holds_alternative<std::string>(value);
}

std::string binary_frame(const Channels& channels) {
  const std::size_t n = channels.size();
  std::int64_t base = 0;
  for (const LiveChannel* channel : channels) base = std::max(base, acquired_ms(*channel));

  std::string frame(kFrameHeader + kFrameRow * n, '\0');
  frame[0] = 1;
  put(frame, 4, static_cast<std::uint32_t>(n));
  put(frame, 8, static_cast<double>(base));
  std::size_t value = kFrameHeader;
  std::size_t id = value + 8 * n;
  std::size_t age = id + 4 * n;
  std::size_t quality = age + 4 * n;
  for (const LiveChannel* channel : channels) {
    const std::int64_t passed = base - acquired_ms(*channel);
    const bool told = channel->last.acquired_at.nanoseconds != 0 && passed < kNoAge;
    put(frame, value, number_of(channel->last));
    put(frame, id, channel->id);
    put(frame, age, told ? static_cast<std::uint32_t>(passed) : kNoAge);
    frame[quality] = static_cast<char>(channel->last.quality);
    value += 8;
    id += 4;
    age += 4;
    quality += 1;
  }
  return frame;
}

std::string values_message(const Channels& channels) {
  std::string ids, values, times, qualities;
  for (const LiveChannel* channel : channels) {
    const LiveValue& last = channel->last;
    if (last.acquired_at.nanoseconds == 0 || !needs_text(last.value)) continue;
    if (!ids.empty()) {
      for (std::string* list : {&ids, &values, &times, &qualities}) *list += ',';
    }
    ids += std::to_string(channel->id);
    append_json_value(values, last.value);
    append_json_number(times, static_cast<double>(acquired_ms(*channel)));
    qualities += std::to_string(static_cast<unsigned>(last.quality));
  }
  if (ids.empty()) return {};
  return JsonObject()
      .add("kind", "values")
      .add_json("id", '[' + ids + ']')
      .add_json("value", '[' + values + ']')
      .add_json("acquired_ms", '[' + times + ']')
      .add_json("quality", '[' + qualities + ']')
      .take();
}

void FrameCache::expire(Instant now) {
  if (!kept_.empty() && now - oldest_ > kLife) kept_.clear();
}

LiveFrame FrameCache::frame(std::uint64_t version, const LiveSubscription& subscription,
                            Instant now) {
  ++counters_.asked;
  expire(now);
  const std::pair key{version, subscription.key()};
  if (const auto found = kept_.find(key); found != kept_.end()) return found->second;

  Channels changed = model_.changed_since(version, kMaxChannels);
  LiveFrame frame;
  frame.version = changed.size() < kMaxChannels ? model_.version() : changed.back()->version;
  std::erase_if(
      changed, [&](const LiveChannel* channel) { return !subscription.matches(channel->channel); });
  frame.channels = changed.size();
  frame.binary = std::make_shared<const std::string>(binary_frame(changed));
  if (std::string texts = values_message(changed); !texts.empty())
    frame.texts = std::make_shared<const std::string>(std::move(texts));
  ++counters_.encoded;
  if (kept_.empty()) oldest_ = now;
  kept_.emplace(key, frame);
  return frame;
}

}  // namespace fieldcast::web
