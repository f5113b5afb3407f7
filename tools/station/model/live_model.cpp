#include "tools/station/model/live_model.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::web {

namespace {

// The table shrinks when it has more buckets than this and most rows were forgotten.
constexpr std::size_t kMostEmptyBuckets = 1'024;

}  // namespace

void LiveModel::touch_value(Row& row) {
  row.live.version = ++version_;
  if (row.changed == changed_.end()) {
    row.changed = changed_.insert(changed_.end(), &row);
  } else {
    changed_.splice(changed_.end(), changed_, row.changed);
  }
}

void LiveModel::touch_catalogue(Row& row) {
  row.live.catalogued = ++catalogue_version_;
  catalogued_.splice(catalogued_.end(), catalogued_, row.catalogued);
}

void LiveModel::forget(Row& row) {
  forgotten_ = std::max(forgotten_, row.live.catalogued);
  if (row.changed != changed_.end()) changed_.erase(row.changed);
  catalogued_.erase(row.catalogued);
  --gone_;
  ++counters_.forgotten;
  const StationChannel& channel = row.live.channel;
  rows_.erase(rows_.find(PathView{channel.bus, channel.device, channel.channel}));
}

bool LiveModel::make_room() {
  if (rows_.size() < max_channels_) return true;
  if (gone_ == 0) return false;
  const auto oldest = std::find_if(catalogued_.begin(), catalogued_.end(),
                                   [](const Row* row) { return row->live.gone; });
  forget(**oldest);
  return true;
}

void LiveModel::on_channel(const StationChannel& channel, Origin origin) {
  const PathView path{channel.bus, channel.device, channel.channel};
  auto found = rows_.find(path);
  if (found == rows_.end()) {
    if (!make_room()) {
      ++counters_.refused;
      return;
    }
    found = rows_.emplace(path.owned(), std::make_unique<Row>()).first;
    Row& row = *found->second;
    row.live.id = next_id_++;
    row.changed = changed_.end();
    row.catalogued = catalogued_.insert(catalogued_.end(), &row);
  } else if (found->second->live.channel == channel && !found->second->live.gone) {
    return;
  }
  Row& row = *found->second;
  row.live.channel = channel;
  row.live.origin = origin;
  if (std::exchange(row.live.gone, false)) --gone_;
  row.left.reset();
  touch_catalogue(row);
}

void LiveModel::on_sample(const PathView& path, LiveValue value, Instant now) {
  const auto found = rows_.find(path);
  if (found == rows_.end() || found->second->live.gone) {
    ++counters_.unknown;
    return;
  }
  ++counters_.samples;
  found->second->live.last = std::move(value);
  found->second->live.arrived = now;
  touch_value(*found->second);
}

void LiveModel::on_sample(const StationSample& sample, Instant now) {
  on_sample({sample.bus, sample.device, sample.channel},
            {sample.value, sample.quality, sample.device_code, sample.acquired_at, sample.sequence},
            now);
}

void LiveModel::on_gone(const PathView& path) {
  const auto found = rows_.find(path);
  if (found == rows_.end() || found->second->live.gone) return;
  Row& row = *found->second;
  row.live.gone = true;
  ++gone_;
  touch_catalogue(row);
  if (row.live.last.quality != Quality::kGood) return;
  row.live.last.quality = Quality::kUncertain;
  touch_value(row);
}

void LiveModel::on_silent(const std::string& site) {
  const std::string prefix = site + ':';
  for (const auto& [path, row] : rows_) {
    LiveChannel& live = row->live;
    if (live.origin != Origin::kStream || live.gone || live.last.quality != Quality::kGood ||
        !live.channel.bus.starts_with(prefix))
      continue;
    live.last.quality = Quality::kUncertain;
    touch_value(*row);
  }
}

std::size_t LiveModel::expire(Instant now) {
  std::size_t count = 0;
  std::vector<Row*> departed;
  for (const auto& [path, row] : rows_) {
    LiveChannel& live = row->live;
    if (live.gone && !row->left) row->left = now;
    if (live.gone && now - *row->left >= kRemembered && departed.size() < kMostForgotten)
      departed.push_back(row.get());
    const Duration refresh = live.channel.refresh;
    if (live.gone || live.last.quality != Quality::kGood || refresh <= Duration{}) continue;
    const Duration patience = live.origin == Origin::kStream ? kStreamPatience : kPatience;
    if (now - live.arrived <= kPatienceRefreshes * refresh + patience) continue;
    live.last.quality = Quality::kUncertain;
    touch_value(*row);
    ++count;
  }
  for (Row* row : departed) forget(*row);
  if (rows_.bucket_count() > kMostEmptyBuckets + 4 * rows_.size()) rows_.rehash(0);
  return count;
}

const LiveChannel* LiveModel::find(const PathView& path) const {
  const auto found = rows_.find(path);
  return found == rows_.end() ? nullptr : &found->second->live;
}

std::vector<const LiveChannel*> LiveModel::channels() const {
  std::vector<const LiveChannel*> all;
  all.reserve(rows_.size());
  for (const auto& [path, row] : rows_) {
    if (!row->live.gone) all.push_back(&row->live);
  }
  std::sort(all.begin(), all.end(), [](const LiveChannel* a, const LiveChannel* b) {
    return std::tie(a->channel.bus, a->channel.device, a->channel.channel) <
           std::tie(b->channel.bus, b->channel.device, b->channel.channel);
  });
  return all;
}

std::vector<const LiveChannel*> LiveModel::changed_since(std::uint64_t version,
                                                         std::size_t limit) const {
  auto first = changed_.end();
  std::size_t count = 0;
  while (first != changed_.begin() && (*std::prev(first))->live.version > version) {
    --first;
    ++count;
  }
  std::vector<const LiveChannel*> changed;
  changed.reserve(std::min(count, limit));
  for (; first != changed_.end() && changed.size() < limit; ++first)
    changed.push_back(&(*first)->live);
  return changed;
}

LiveModel::CatalogueChange LiveModel::catalogue_since(std::uint64_t version) const {
  CatalogueChange change;
  // An unknown version was issued by a previous process.
  change.full = version == 0 || version < forgotten_ || version > catalogue_version_;
  auto first = change.full ? catalogued_.begin() : catalogued_.end();
  if (!change.full) {
    while (first != catalogued_.begin() && (*std::prev(first))->live.catalogued > version) --first;
  }
  for (; first != catalogued_.end(); ++first) {
    const LiveChannel& live = (*first)->live;
    if (!live.gone) {
      change.changed.push_back(&live);
    } else if (!change.full) {
      change.gone.push_back(live.id);
    }
  }
  return change;
}

}  // namespace fieldcast::web
