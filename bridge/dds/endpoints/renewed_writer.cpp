#include "bridge/dds/endpoints/renewed_writer.hpp"

#include <utility>

namespace fieldcast {

struct RenewedWriter::Entity : dds::DataWriterListener {
  explicit Entity(const RenewedWriter& owner) : of(owner) {}
  ~Entity() override {
    if (writer != nullptr) of.domain_.remove(writer);
  }

  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    readers = static_cast<std::uint32_t>(status.current_count);
    if (status.current_count_change > 0 && of.matched_) of.matched_();
  }

  const RenewedWriter& of;
  dds::DataWriter* writer = nullptr;
  std::atomic<std::uint32_t> readers{0};
};

RenewedWriter::RenewedWriter(Domain& domain, Make make, std::function<void()> matched,
                             std::uint64_t most)
    : domain_(domain), make_(std::move(make)), matched_(std::move(matched)), most_(most) {
  current_ = make_entity();
}

RenewedWriter::~RenewedWriter() = default;

std::unique_ptr<RenewedWriter::Entity> RenewedWriter::make_entity() {
  auto made = std::make_unique<Entity>(*this);
  made->writer = make_(made.get(), dds::StatusMask::publication_matched());
  return made;
}

void RenewedWriter::write(void* message) {
  const std::shared_lock lock(mutex_);
  ++written_;
  current_->writer->write(message);
}

void RenewedWriter::unregister(void* message) {
  const std::shared_lock lock(mutex_);
  current_->writer->unregister_instance(message, dds::HANDLE_NIL);
}

std::uint32_t RenewedWriter::readers() const {
  const std::shared_lock lock(mutex_);
  return current_->readers;
}

void RenewedWriter::tidy(Instant now) {
  const std::unique_lock alone(tidying_, std::try_to_lock);
  if (!alone) return;
  const bool is_due = now - since_ >= kOverlap;
  if (former_) {
    if (is_due) former_.reset();
  } else if (next_) {
    if (!is_due) return;
    since_ = now;
    const std::unique_lock lock(mutex_);
    former_ = std::exchange(current_, std::move(next_));
    written_ = 0;
  } else if (written_ >= most_) {
    since_ = now;
    try {
      next_ = make_entity();
    } catch (const DdsError&) { return; }
  }
}

}  // namespace fieldcast
