#include "tmcl/model_document.hpp"

#include <algorithm>
#include <array>

namespace tmcl {
namespace {

struct Row {
  std::uint16_t model;
  std::string_view document;
};

// Of "manual", the title is "TMCL Firmware Manual".
constexpr auto own_documents = std::to_array<Row>({
    {142, "manual of the TMCM-142, V1.06"},
    {351, "manual of the TMCM-351, V4.45, Rev. 1.06"},
    {1021, "manual of the TMCM-1021"},
    {1311, "manual of the TMCM-1311, in parts"},
    {6110, "manual of the TMCM-6110"},
});

}  // namespace

std::string_view document_of(const Model& model) {
  const auto* own = std::ranges::find(own_documents, model.number, &Row::model);
  if (own != own_documents.end()) return own->document;
  switch (model.family) {
    case Family::tmc429: return "none of its own: as the TMCM-6110";
    case Family::tmc457: return "none of its own: as the TMCM-142";
    case Family::sixpoint: return "none of its own: manual of the TMCM-3212";
    case Family::tmc4361: return "none: widths of the chip's registers";
    case Family::firmware: return "none of its own: as the TMCM-1021";
  }
  return {};
}

}  // namespace tmcl
