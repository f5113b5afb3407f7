#include "tools/sim/stand_in.hpp"

#include <algorithm>
#include <cassert>

#include "core/model/make_protocol.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::uint8_t kAsked = 0x55, kAnswered = 0xAA;

Reply empty_reply(const Request& request, std::span<const Area> areas) {
  const auto zeros = [&](const Range& range) {
    return RangeReply{Cause::kNone, 0, Bytes(image_bytes(areas[range.area].item_bits, range.count))};
  };
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    Reply reply;
    for (const Range& range : read->ranges) reply.push_back(zeros(range));
    return reply;
  }
  if (const auto* both = std::get_if<WriteReadRequest>(&request)) return {{}, zeros(both->read)};
  return {{}};
}

class StandInExchange final : public Exchange {
 public:
  StandInExchange(const ExchangeSize& size, Reply reply, std::shared_ptr<StandInRound> round)
      : size_(size), reply_(std::move(reply)), round_(std::move(round)) {}

  Step start(Bytes& out) override { return send(out); }

  Step on_bytes(ByteView all, Bytes&) override {
    heard_ = heard_ || !all.empty();
    if (all.size() < round_->answer) return Step::need_rest(round_->answer - static_cast<std::uint32_t>(all.size()));
    if (!std::ranges::all_of(all.first(round_->answer), [](std::uint8_t c) { return c == kAnswered; }))
      return Step::failed(Cause::kChecksum);
    if (++rounds_done_ == size_.rounds) return Step::done();
    waiting_ = true;
    return Step::pause_for(size_.pauses / (size_.rounds - 1));
  }

  Step on_silence(Bytes& out) override {
    if (waiting_) return send(out);
    return Step::failed(heard_ ? Cause::kTruncated : Cause::kNoAnswer);
  }

  const Reply& reply() const override { return reply_; }

 private:
  // All but the last round are short: an acknowledgement, a poll. Together they have the characters of the whole exchange.
  Step send(Bytes& out) {
    waiting_ = heard_ = false;
    const std::uint32_t short_ones = size_.rounds - 1;
    const bool last = rounds_done_ == short_ones;
    const auto rest = [&](std::uint32_t characters) { return characters > short_ones ? characters - short_ones : 1; };
    *round_ = {last ? rest(size_.request_characters) : 1, last ? rest(size_.answer_characters) : 1, 0, true};
    out.assign(round_->request, kAsked);
    return Step::send(round_->answer);
  }

  ExchangeSize size_;
  Reply reply_;
  std::shared_ptr<StandInRound> round_;
  std::uint32_t rounds_done_ = 0;
  bool waiting_ = false;
  bool heard_ = false;  // anything of this round's answer
};

class StandInProtocol final : public Protocol {
 public:
  StandInProtocol(std::unique_ptr<Protocol> real, std::shared_ptr<StandInRound> round)
      : real_(std::move(real)), round_(std::move(round)) {}
  const Traits& traits() const override { return real_->traits(); }
  std::span<const Area> areas() const override { return real_->areas(); }
  tl::expected<ParsedAddress, AddressFault> parse_address(std::string_view at) const override { return real_->parse_address(at); }
  std::optional<ExchangeSize> size(const Request& request) const override { return real_->size(request); }
  std::unique_ptr<Exchange> begin(Request request, ExchangeContext) const override {
    return std::make_unique<StandInExchange>(*real_->size(request), empty_reply(request, real_->areas()), round_);
  }

 private:
  std::unique_ptr<Protocol> real_;
  std::shared_ptr<StandInRound> round_;
};

class StandInDevice final : public SimDevice {
 public:
  explicit StandInDevice(std::shared_ptr<StandInRound> round) : round_(std::move(round)) {}
  std::unique_ptr<Ear> open_ear() override;
  const DeviceStatistics& statistics() const override { return statistics_; }

  void hear(Reaction& reaction) {
    if (!round_->open || ++round_->heard < round_->request) return;
    round_->open = false;
    ++statistics_.requests["?"];
    ++statistics_.answers;
    reaction.answer.assign(round_->answer, kAnswered);
  }

 private:
  std::shared_ptr<StandInRound> round_;
  DeviceStatistics statistics_;
};

class StandInEar final : public Ear {
 public:
  explicit StandInEar(StandInDevice& device) : device_(device) {}
  void hear(std::uint8_t, Instant, Reaction& reaction) override { device_.hear(reaction); }

 private:
  StandInDevice& device_;
};

std::unique_ptr<Ear> StandInDevice::open_ear() { return std::make_unique<StandInEar>(*this); }

}  // namespace

bool StandIns::needed(const DeviceSpec& device) { return kind_of(device) == nullptr; }

std::unique_ptr<Protocol> StandIns::protocol(const DeviceSpec& device, const LineFormat& line) {
  auto real = make_protocol(device, line);
  assert(real && "the loader checks protocols, addresses and options");
  if (!needed(device)) return std::move(*real);
  auto& round = rounds_[device.name];
  if (!round) round = std::make_shared<StandInRound>();
  return std::make_unique<StandInProtocol>(std::move(*real), round);
}

std::unique_ptr<SimDevice> StandIns::device(const DeviceSetup& setup) {
  auto& round = rounds_[setup.spec.name];
  if (!round) round = std::make_shared<StandInRound>();
  return std::make_unique<StandInDevice>(round);
}

}  // namespace fieldcast::sim
