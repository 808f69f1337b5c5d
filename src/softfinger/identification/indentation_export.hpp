#pragma once

#include <filesystem>
#include <memory>

#include "softfinger/finger/finger_model.hpp"
#include "softfinger/identification/indentation.hpp"

namespace softfinger {

/// A press as files in a folder, which is made if absent: nodes.csv, contact.csv and features.csv,
/// and patches.csv where dilatation is taken over patches: enough for anyone to recompute the
/// balance of forces. Throws OperationError where they cannot be written.
class IndentationExport {
 public:
  /// `model` must outlive it.
  IndentationExport(const std::filesystem::path& folder, const FingerModel& model);
  ~IndentationExport();
  IndentationExport(const IndentationExport&) = delete;
  IndentationExport& operator=(const IndentationExport&) = delete;

  /// `row`: from 1.
  void write(int row, const IndentationState& state);
  void close();

 private:
  struct Files;
  std::unique_ptr<Files> files_;
};

}  // namespace softfinger
