// Makes the message of a record in the configured form. One owner.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "tools/forward/batch/sample_batch.hpp"
#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/queue/queue.hpp"

namespace fieldcast::forward {

enum class PayloadFormat : std::uint8_t { kProtobuf, kJson };

struct PayloadSpec {
  PayloadFormat format = PayloadFormat::kProtobuf;
  bool compress = false;  // with zstd; catalogues and alarms stay as they are
  friend bool operator==(const PayloadSpec&, const PayloadSpec&) = default;
};

class MessageMaker {
 public:
  // `catalogue(identity)` returns the encoded catalogue, for JSON.
  using FindCatalogue = std::function<std::optional<std::string>(std::uint64_t identity)>;
  MessageMaker(std::string site, std::string bucket, const PayloadSpec& spec,
               FindCatalogue catalogue)
      : site_(std::move(site)),
        bucket_(std::move(bucket)),
        spec_(spec),
        catalogue_(std::move(catalogue)) {}

  // Empty if the record cannot be decoded, or its catalogue is missing.
  [[nodiscard]] std::optional<OutletMessage> make(const Record& record);

 private:
  static constexpr std::size_t kMaxCatalogues = 1024;  // then they are read again

  [[nodiscard]] std::optional<std::string> json_of(const Record& record);
  [[nodiscard]] const DeviceCatalogue* catalogue_of(std::uint64_t identity);

  const std::string site_, bucket_;
  const PayloadSpec spec_;
  const FindCatalogue catalogue_;
  std::map<std::uint64_t, DeviceCatalogue> catalogues_;
};

}  // namespace fieldcast::forward
