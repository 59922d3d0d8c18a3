// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "deploy/simulation/material.h"

#include <algorithm>

namespace coslam::sim {
namespace {

float raw_albedo(const Material& m, const SurfacePoint& p) {
  switch (m.kind) {
    case MaterialKind::kBrick:
      return brick_albedo(m, p);
    case MaterialKind::kPlaster:
      return plaster_albedo(m, p);
    case MaterialKind::kPlanks:
      return planks_albedo(m, p);
    case MaterialKind::kTiles:
      return tiles_albedo(m, p);
    case MaterialKind::kCeiling:
      return ceiling_albedo(m, p);
    case MaterialKind::kWood:
      return wood_albedo(m, p);
    case MaterialKind::kFabric:
      return fabric_albedo(m, p);
    case MaterialKind::kRug:
      return rug_albedo(m, p);
    case MaterialKind::kCarton:
      return carton_albedo(m, p);
    case MaterialKind::kPoster:
      return poster_albedo(m, p);
    case MaterialKind::kPicture:
      return picture_albedo(m, p);
    case MaterialKind::kNewspaper:
      return newspaper_albedo(m, p);
    case MaterialKind::kBookSpine:
      return book_spine_albedo(m, p);
    case MaterialKind::kPages:
      return pages_albedo(m, p);
    case MaterialKind::kScreen:
      return screen_albedo(m, p);
    case MaterialKind::kLeaf:
      return leaf_albedo(m, p);
    case MaterialKind::kFoliage:
      return foliage_albedo(m, p);
    case MaterialKind::kPaint:
      return paint_albedo(m, p);
    case MaterialKind::kCheckedCloth:
      return checked_cloth_albedo(m, p);
    case MaterialKind::kPrintedCloth:
      return printed_cloth_albedo(m, p);
    case MaterialKind::kStripedCloth:
      return striped_cloth_albedo(m, p);
    case MaterialKind::kDenim:
      return denim_albedo(m, p);
    case MaterialKind::kFace:
      return face_albedo(m, p);
    case MaterialKind::kHand:
      return hand_albedo(m, p);
    case MaterialKind::kShoe:
      return shoe_albedo(m, p);
    case MaterialKind::kTag:
      return tag_albedo(m, p);
    case MaterialKind::kLamp:
      break;
  }
  return m.tone;
}

}  // namespace

float albedo(const Material& material, const SurfacePoint& p) {
  return std::clamp(raw_albedo(material, p), 0.02F, 0.95F);
}

}  // namespace coslam::sim
