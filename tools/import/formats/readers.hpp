// Readers of all formats, each defined in the file of its name.
#pragma once

#include "tools/import/formats/format.hpp"

namespace fieldcast::importing {

using Read = tl::expected<Found, std::string>;

[[nodiscard]] Confidence recognise_kepware(const SourceText& source);
[[nodiscard]] Read read_kepware(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_telegraf(const SourceText& source);
[[nodiscard]] Read read_telegraf(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_mqmgateway(const SourceText& source);
[[nodiscard]] Read read_mqmgateway(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_epics(const SourceText& source);
[[nodiscard]] Read read_epics(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_wb(const SourceText& source);
[[nodiscard]] Read read_wb(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_neuron(const SourceText& source);
[[nodiscard]] Read read_neuron(std::span<const SourceText> sources, const ReadOptions& options);

[[nodiscard]] Confidence recognise_modbus_list(const SourceText& source);
[[nodiscard]] Read read_modbus_list(std::span<const SourceText> sources,
                                    const ReadOptions& options);

}  // namespace fieldcast::importing
