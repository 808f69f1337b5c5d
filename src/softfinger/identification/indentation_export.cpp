#include "softfinger/identification/indentation_export.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "softfinger/base/error.hpp"
#include "softfinger/base/units.hpp"

namespace softfinger {
struct IndentationExport::Files {
  /// A file that is written anew; whatever does not fit on the disk is an error by the end of
  /// close().
  class NewFile {
   public:
    explicit NewFile(const std::filesystem::path& file)
        : file_(file), stream_(std::fopen(file.c_str(), "w"), std::fclose) {
      if (!stream_) fail();
    }
    template <typename... Values>
    void print(fmt::format_string<Values...> form, Values&&... values) {
      const std::string text = fmt::format(form, std::forward<Values>(values)...);
      if (std::fwrite(text.data(), 1, text.size(), stream_.get()) != text.size()) fail();
    }
    void close() {
      if (std::fclose(stream_.release()) != 0) fail();
    }

   private:
    [[noreturn]] void fail() const {
      throw OperationError(
          fmt::format("{}: cannot be written (is there room on the disk?)", file_.string()));
    }
    std::filesystem::path file_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
  };

  Files(const std::filesystem::path& directory, const FingerModel& model)
      : directory_(directory),
        sample_nodes_(model.sample_nodes),
        nodes_(open(directory, "nodes.csv")),
        contact_(open(directory, "contact.csv")),
        features_(open(directory, "features.csv")) {
    nodes_.print("row,node,x_mm,y_mm,z_mm\n");
    contact_.print("row,sample,gap_mm,force_x_N,force_y_N,force_z_N,in_contact\n");
    features_.print(
        "row,node_a,node_b,node_c,weight_a,weight_b,weight_c,gap_mm,force_x_N,force_y_N,"
        "force_z_N\n");
  }

  void write(int row, const IndentationState& state) {
    if (row == 1 && !state.patches.empty()) write_patches(state.patches);
    for (std::size_t n = 0; n < state.positions.size(); ++n) {
      const Vector3 p = state.positions[n] / mm;
      nodes_.print("{},{},{},{},{}\n", row, n, p.x(), p.y(), p.z());
    }
    for (std::size_t i = 0; i < state.contact.samples.size(); ++i) {
      const ContactSample& s = state.contact.samples[i];
      const Vector3 f = state.X_WF.rotation * Vector3(s.normal_force_F + s.tangential_force_F);
      contact_.print("{},{},{},{},{},{},{}\n", row, i, s.gap / mm, f.x(), f.y(), f.z(),
                     s.in_contact ? 1 : 0);
    }
    for (const ContactFeature& feature : state.contact.features()) {
      const Vector3 f =
          state.X_WF.rotation * Vector3(feature.normal_force_F + feature.tangential_force_F);
      const auto& w = feature.weights;
      features_.print("{},{},{},{},{},{},{},{},{},{},{}\n", row, node(feature.samples[0]),
                      node(feature.samples[1]), node(feature.samples[2]), w[0], w[1], w[2],
                      feature.gap / mm, f.x(), f.y(), f.z());
    }
  }

  void close() {
    nodes_.close();
    contact_.close();
    features_.close();
  }

  [[nodiscard]] int node(int sample) const {
    return sample_nodes_[static_cast<std::size_t>(sample)];
  }
  static NewFile open(const std::filesystem::path& directory, const char* name) {
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);
    return NewFile(directory / name);
  }
  /// Tetrahedra in the order of the mesh file; those that do not deform are in no patch.
  void write_patches(std::span<const int> patches) const {
    NewFile file = open(directory_, "patches.csv");
    file.print("tetrahedron,patch\n");
    for (std::size_t t = 0; t < patches.size(); ++t) {
      if (patches[t] >= 0) file.print("{},{}\n", t, patches[t]);
    }
    file.close();
  }

  std::filesystem::path directory_;
  const std::vector<int>& sample_nodes_;
  NewFile nodes_, contact_, features_;
};

IndentationExport::IndentationExport(const std::filesystem::path& folder, const FingerModel& model)
    : files_(std::make_unique<Files>(folder, model)) {}
IndentationExport::~IndentationExport() = default;

void IndentationExport::write(int row, const IndentationState& state) { files_->write(row, state); }

void IndentationExport::close() { files_->close(); }

}  // namespace softfinger
