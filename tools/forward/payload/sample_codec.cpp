#include <algorithm>
#include <type_traits>
#include <vector>

#include "schema/forward.pb.h"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

bool is_single(double number) { return static_cast<double>(static_cast<float>(number)) == number; }

// Adds the value to the column of its kind.
v1::Kind add_value(const Value& value, v1::SampleBatch& out) {
  return std::visit(
      [&](const auto& held) {
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, bool>) {
          out.add_booleans(held);
          return v1::BOOLEAN;
        } else if constexpr (std::is_same_v<Held, std::int64_t>) {
          out.add_integers(held);
          return v1::INTEGER;
        } else if constexpr (std::is_same_v<Held, std::uint64_t>) {
          out.add_naturals(held);
          return v1::NATURAL;
        } else if constexpr (std::is_same_v<Held, double>) {
          if (is_single(held)) {
            out.add_singles(static_cast<float>(held));
            return v1::SINGLE;
          }
          out.add_reals(held);
          return v1::REAL;
        } else {
          out.add_texts(held);
          return v1::TEXT;
        }
      },
      value);
}

// Differences wrap around, so that every 64-bit number is restored.
std::int64_t difference(std::uint64_t to, std::uint64_t from) {
  return static_cast<std::int64_t>(to - from);
}

class ValueReader {
 public:
  explicit ValueReader(const v1::SampleBatch& from) : from_(from) {}

  // Empty if the columns have no further value.
  std::optional<Value> next() {
    while (left_ == 0) {
      if (run_ + 1 >= from_.kinds_size()) return std::nullopt;
      kind_ = from_.kinds(run_);
      left_ = from_.kinds(run_ + 1);
      run_ += 2;
    }
    --left_;
    switch (kind_) {
      case v1::BOOLEAN: return take(from_.booleans(), booleans_);
      case v1::INTEGER: return take(from_.integers(), integers_);
      case v1::NATURAL: return take(from_.naturals(), naturals_);
      case v1::REAL: return take(from_.reals(), reals_);
      case v1::SINGLE: return take_single();
      case v1::TEXT: return take(from_.texts(), texts_);
      default: return std::nullopt;
    }
  }

 private:
  template <class Column>
  static std::optional<Value> take(const Column& column, int& at) {
    if (at >= column.size()) return std::nullopt;
    using Item = std::decay_t<decltype(column.Get(0))>;
    if constexpr (std::is_same_v<Item, std::string> || std::is_same_v<Item, bool> ||
                  std::is_same_v<Item, double>) {
      return Value(column.Get(at++));
    } else if constexpr (std::is_signed_v<Item>) {
      return Value(std::int64_t{column.Get(at++)});
    } else {
      return Value(std::uint64_t{column.Get(at++)});
    }
  }
  std::optional<Value> take_single() {
    if (singles_ >= from_.singles_size()) return std::nullopt;
    return Value(static_cast<double>(from_.singles(singles_++)));
  }

  const v1::SampleBatch& from_;
  int run_ = 0;
  std::uint32_t kind_ = 0, left_ = 0;
  int booleans_ = 0, integers_ = 0, naturals_ = 0, reals_ = 0, singles_ = 0, texts_ = 0;
};

bool read_qualities(const v1::SampleBatch& from, SampleBatch& to) {
  std::uint64_t at = 0;
  if (from.qualities_size() % 3 != 0) return false;
  for (int i = 0; i < from.qualities_size(); i += 3) {
    at += from.qualities(i);
    const std::uint32_t quality = from.qualities(i + 1);
    if (at >= to.samples.size() || quality > static_cast<std::uint32_t>(Quality::kNotYetRead))
      return false;
    to.samples[at].quality = static_cast<Quality>(quality);
    to.samples[at].device_code = static_cast<std::uint16_t>(from.qualities(i + 2));
  }
  return true;
}

void add_channels(const SampleBatch& batch, v1::SampleBatch& out) {
  std::uint32_t next = 0;
  bool several = false;
  for (std::size_t i = 0; i < batch.samples.size();) {
    const std::size_t first = i;
    const std::uint32_t channel = batch.samples[first].channel;
    while (i < batch.samples.size() && batch.samples[i].channel == channel) ++i;
    const int last = out.channels_size() - 1;
    if (last > 0 && channel == next) {
      out.set_channels(last, out.channels(last) + 1);
    } else {
      out.add_channels(channel - next);
      out.add_channels(1);
    }
    next = channel + 1;
    out.add_counts(static_cast<std::uint32_t>(i - first));
    several = several || i - first > 1;
  }
  if (!several) out.clear_counts();
}

// Calls on_sample(channel) for each sample. Returns false if a column is too short.
template <class OnSample>
bool for_each_channel(const v1::SampleBatch& from, OnSample on_sample) {
  std::uint32_t channel = 0;
  int at = 0;  // in counts
  for (int pair = 0; pair + 1 < from.channels_size(); pair += 2) {
    channel += from.channels(pair);
    for (std::uint32_t i = 0; i < from.channels(pair + 1); ++i, ++channel) {
      if (from.counts_size() != 0 && at >= from.counts_size()) return false;
      const std::uint32_t samples = from.counts_size() == 0 ? 1 : from.counts(at++);
      for (std::uint32_t j = 0; j < samples; ++j) {
        if (!on_sample(channel)) return false;
      }
    }
  }
  return at == from.counts_size() && from.channels_size() % 2 == 0;
}

// Adds the different times, and for each sample the index of its time.
void add_instants(const SampleBatch& batch, v1::SampleBatch& out) {
  std::vector<std::int64_t> instants;
  instants.reserve(batch.samples.size());
  for (const BatchSample& sample : batch.samples)
    instants.push_back(sample.acquired_at.nanoseconds);
  std::sort(instants.begin(), instants.end());
  instants.erase(std::unique(instants.begin(), instants.end()), instants.end());
  std::uint64_t time = 0;
  for (const std::int64_t instant : instants) {
    out.add_instants(difference(static_cast<std::uint64_t>(instant), time));
    time = static_cast<std::uint64_t>(instant);
  }
  std::int32_t last = 0;
  for (const BatchSample& sample : batch.samples) {
    const auto at =
        std::lower_bound(instants.begin(), instants.end(), sample.acquired_at.nanoseconds);
    const auto index = static_cast<std::int32_t>(at - instants.begin());
    out.add_acquired_at(index - last);
    last = index;
  }
}

std::vector<UtcTime> read_instants(const v1::SampleBatch& from) {
  std::vector<UtcTime> instants;
  std::uint64_t time = 0;
  for (const std::int64_t step : from.instants()) {
    time += static_cast<std::uint64_t>(step);
    instants.push_back({static_cast<std::int64_t>(time)});
  }
  return instants;
}

}  // namespace

std::string encode(const SampleBatch& batch) {
  v1::SampleBatch out;
  out.set_schema(kSchema);
  out.set_epoch(batch.epoch);
  out.set_catalogue(batch.catalogue);
  add_channels(batch, out);
  add_instants(batch, out);
  std::uint64_t sequence = 0;
  std::uint32_t last_bad = 0;
  for (std::size_t i = 0; i < batch.samples.size(); ++i) {
    const BatchSample& sample = batch.samples[i];
    out.add_sequences(difference(sample.sequence, sequence));
    sequence = sample.sequence;
    const v1::Kind kind = add_value(sample.value, out);
    const int last = out.kinds_size() - 2;
    if (last >= 0 && out.kinds(last) == static_cast<std::uint32_t>(kind)) {
      out.set_kinds(last + 1, out.kinds(last + 1) + 1);
    } else {
      out.add_kinds(kind);
      out.add_kinds(1);
    }
    if (sample.quality == Quality::kGood && sample.device_code == 0) continue;
    const auto index = static_cast<std::uint32_t>(i);
    out.add_qualities(index - last_bad);
    out.add_qualities(static_cast<std::uint32_t>(sample.quality));
    out.add_qualities(sample.device_code);
    last_bad = index;
  }
  return out.SerializeAsString();
}

// The field has number 1 and is written first: 08, and then a varint.
std::optional<std::uint64_t> schema_of(std::string_view text) {
  constexpr char kField = 0x08;
  constexpr unsigned kMore = 0x80;
  if (text.empty() || text.front() != kField) return std::nullopt;
  std::uint64_t schema = 0;
  unsigned shift = 0;
  for (const char c : text.substr(1)) {
    const auto byte = static_cast<unsigned char>(c);
    schema |= std::uint64_t{byte & ~kMore} << shift;
    if ((byte & kMore) == 0) return schema;
    if ((shift += 7) > 63) return std::nullopt;
  }
  return std::nullopt;
}

std::optional<SampleBatch> decode_samples(std::string_view text) {
  v1::SampleBatch from;
  if (!from.ParseFromArray(text.data(), static_cast<int>(text.size()))) return std::nullopt;
  const int count = from.sequences_size();
  if (from.schema() != kSchema || from.acquired_at_size() != count) return std::nullopt;
  SampleBatch to;
  to.epoch = from.epoch();
  to.catalogue = from.catalogue();
  to.samples.reserve(static_cast<std::size_t>(count));
  ValueReader values(from);
  const std::vector<UtcTime> instants = read_instants(from);
  std::uint64_t sequence = 0;
  std::int64_t instant = 0;
  const bool is_whole = for_each_channel(from, [&](std::uint32_t channel) {
    const auto at = static_cast<int>(to.samples.size());
    if (at >= count) return false;
    sequence += static_cast<std::uint64_t>(from.sequences(at));
    instant += from.acquired_at(at);
    std::optional<Value> value = values.next();
    if (!value || instant < 0 || instant >= static_cast<std::int64_t>(instants.size()))
      return false;
    to.samples.push_back({.channel = channel,
                          .sequence = sequence,
                          .acquired_at = instants[static_cast<std::size_t>(instant)],
                          .value = *std::move(value)});
    return true;
  });
  if (!is_whole) return std::nullopt;
  if (static_cast<int>(to.samples.size()) != count || !read_qualities(from, to))
    return std::nullopt;
  return to;
}

}  // namespace fieldcast::forward
