#include "core/protocol/declared/reading.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::declared {
namespace {

class Readings {
 public:
  Readings(const Declaration& declaration, ByteView bytes, Sender sender)
      : declaration_(declaration), bytes_(bytes), sender_(sender) {}

  Reading run() {
    for (const Operation& round : declaration_.login) offer_all(round, nullptr);
    for (const Operation& operation : declaration_.operations) {
      const DeclaredArea& area = declaration_.areas[operation.area];
      for (const Operation& round : operation.before) offer_all(round, nullptr);
      offer_all(operation, &area);
      for (const Frame& refusal : declaration_.refusals)
        offer(operation, &area, refusal, "refusal: ", Sender::kDevice);
    }
    if (!alike_.empty())
      best_.fields.front().value +=
          " or " +
          (alike_.size() == 1 ? alike_.front() : std::to_string(alike_.size()) + " others");
    return std::move(best_);
  }

 private:
  void offer_all(const Operation& operation, const DeclaredArea* area) {
    const bool unsolicited = operation.unsolicited > Duration::zero();
    if (!unsolicited) offer(operation, area, operation.request, "request: ", Sender::kBridge);
    const std::string title = unsolicited ? "unsolicited: " : "response: ";
    if (operation.no_response == Duration::zero())
      offer(operation, area, operation.response, title, Sender::kDevice);
    for (const Frame& other : operation.others)
      offer(operation, area, other, title, Sender::kDevice);
  }

  // Of equal readings the first is the best.
  void offer(const Operation& operation, const DeclaredArea* area, const Frame& frame,
             const std::string& title, Sender sender) {
    for (const bool by_length : {false, true}) {
      Reading reading = read_frame(declaration_, operation, area, frame, bytes_,
                                   title + operation.name, title == "refusal: ", by_length);
      reading.from_sender = sender_ == Sender::kUnknown || sender_ == sender;
      if (best_.fields.empty() || reading.rank() > best_.rank())
        best_ = std::move(reading), alike_.clear();
      else if (reading.is_like(best_))
        alike_.push_back(operation.name);
      if (best_.faultless) return;
    }
  }

  const Declaration& declaration_;
  const ByteView bytes_;
  const Sender sender_;
  Reading best_;
  std::vector<std::string> alike_;  // operations that also have the best frame
};

// Equal bytes that wake up a device, or spurious characters of a driver, before the frame. The
// last of them may be the first byte of the frame.
std::optional<std::vector<FrameField>> behind_lead(const Declaration& declaration, ByteView bytes,
                                                   Sender sender, const Reading& whole) {
  const std::size_t equal = equal_bytes(bytes);
  for (std::size_t size = equal; size > 0 && size + 1 >= equal && size < bytes.size(); --size) {
    if (size == 1 && !is_turnaround(bytes.front())) continue;
    Reading reading = Readings(declaration, bytes.subspan(size), sender).run();
    if (reading.rank() <= whole.rank()) continue;
    FieldWriter lead;
    lead.append({reading.fields.front()});
    lead.add(0, size, "lead", to_hex(bytes.first(size)));
    for (FrameField& field : reading.fields) field.offset += size;
    lead.append({reading.fields.begin() + 1, reading.fields.end()});
    return lead.take();
  }
  return std::nullopt;
}

}  // namespace

std::vector<FrameField> explain(const Declaration& declaration, ByteView frame, Sender sender) {
  FieldWriter none;
  if (frame.empty() || frame.size() > kMaxFrame) {
    none.remark("", frame.empty() ? "no bytes" : "longer than any frame of a declared protocol");
    return none.take();
  }
  Reading whole = Readings(declaration, frame, sender).run();
  if (whole.faultless) return std::move(whole.fields);
  return behind_lead(declaration, frame, sender, whole).value_or(std::move(whole.fields));
}

}  // namespace fieldcast::declared
