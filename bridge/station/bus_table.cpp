#include "bridge/station/bus_table.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

bool BusTable::enter(std::uint64_t epoch, const Handlers& handlers) {
  if (epoch < epoch_) return false;
  if (epoch == epoch_) return true;
  for (Row& row : rows_) forget(row, handlers);
  rows_.clear();
  epoch_ = epoch;
  last_number_ = 0;
  hole_ = snapshot_ = false;
  return true;
}

BusTable::Row* BusTable::row(std::uint32_t channel) {
  if (channel >= static_cast<std::uint32_t>(kMaxChannels)) return nullptr;
  if (channel >= rows_.size()) rows_.resize(channel + 1);
  return &rows_[channel];
}

void BusTable::came_below(Row& row) {
  if (row.below < kBehind && ++row.below == kBehind) ++behind_;
}

void BusTable::caught_up(Row& row) {
  if (std::exchange(row.below, std::uint8_t{0}) == kBehind) --behind_;
}

void BusTable::forget(Row& row, const Handlers& handlers) {
  caught_up(row);
  if (row.entry && handlers.gone) handlers.gone(row.sample);
  row = {};
}

void BusTable::on_catalogue(const idl::CatalogueBlock& block, const Handlers& handlers) {
  if (!is_whole(block) || !enter(block.epoch(), handlers)) return;
  if (rows_.size() < block.channels()) rows_.resize(block.channels());
  for (std::size_t i = 0; i < block.entries().size(); ++i) {
    Row& row = rows_[block.first() + i];
    StationChannel entry = from_idl(block, block.entries()[i]);
    if (row.entry && *row.entry == entry) continue;
    const bool known = row.entry != nullptr;
    row.sample.bus = entry.bus;
    row.sample.device = entry.device;
    row.sample.channel = entry.channel;
    row.entry = std::make_unique<StationChannel>(std::move(entry));
    if (handlers.channel) handlers.channel(*row.entry);
    if (!known && row.sample.sequence != 0 && handlers.sample) handlers.sample(row.sample);
  }
}

void BusTable::on_catalogue_gone(std::uint64_t epoch, std::uint32_t first,
                                 const Handlers& handlers) {
  if (epoch != epoch_) return;
  const std::size_t end =
      std::min<std::size_t>(rows_.size(), std::size_t{first} + kEntriesPerBlock);
  for (std::size_t i = first; i < end; ++i) forget(rows_[i], handlers);
  // The epoch ends with its last entry: the next one may be from a clock that is behind.
  if (has_catalogue()) return;
  rows_ = std::vector<Row>();  // its memory, too: 184 bytes for each channel
  behind_ = 0;
  epoch_ = 0;
}

bool BusTable::has_catalogue() const {
  return std::any_of(rows_.begin(), rows_.end(),
                     [](const Row& row) { return row.entry != nullptr; });
}

void BusTable::count(std::uint64_t number) {
  if (last_number_ != 0 && number > last_number_ + 1) {
    hole_ = true;
    missing_ += number - last_number_ - 1;
  }
  last_number_ = number;
}

void BusTable::on_samples(const idl::SampleBlock& block, const Handlers& handlers) {
  if (!is_whole(block)) return;
  // Its writer may disappear before its catalogue arrives, and its end would not be reported then.
  if (block.epoch() > epoch_ && has_catalogue()) return;
  if (!enter(block.epoch(), handlers)) return;
  count(block.number());
  if (block.snapshot()) {
    snapshot_ = true;
    hole_ = false;
  }
  for (std::size_t i = 0; i < block.channels().size(); ++i) {
    Row* const to = row(block.channels()[i]);
    if (to == nullptr) continue;
    if (block.sequences()[i] < to->sample.sequence) came_below(*to);
    if (block.sequences()[i] <= to->sample.sequence) continue;
    caught_up(*to);
    to->sample.epoch = block.epoch();
    if (read_row(block, i, to->sample) && to->entry && handlers.sample) handlers.sample(to->sample);
  }
}

void BusTable::replay(const Handlers& handlers) const {
  for (const Row& row : rows_) {
    if (!row.entry) continue;
    if (handlers.channel) handlers.channel(*row.entry);
    if (handlers.sample && row.sample.sequence != 0) handlers.sample(row.sample);
  }
}

std::optional<StationReadPlan> PlanParts::on_part(const idl::ReadPlan& part) {
  if (part.blocks() > kMaxPlanBlocks || part.block() >= part.blocks()) return std::nullopt;
  Plan& plan = buses_[part.bus().c_str()];
  if (part.number() < plan.number) return std::nullopt;
  if (part.number() > plan.number) plan = {part.number(), {}};
  plan.parts.insert_or_assign(part.block(), part);
  if (plan.parts.size() < part.blocks()) return std::nullopt;
  StationReadPlan whole{.bus = part.bus().c_str(), .plan = {}, .in_force_since = {}};
  for (const auto& [block, each] : plan.parts) append(each, whole.plan);
  whole.in_force_since = {part.in_force_since()};
  plan.parts.clear();
  return whole;
}

}  // namespace fieldcast
