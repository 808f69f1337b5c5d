# Install and export: find_package(softfinger) gives softfinger::softfinger and each module.
