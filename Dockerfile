# Builds the Debian package and installs it into a small image; docs/packaging.md shows how it is used.
FROM debian:12 AS build
WORKDIR /alidade
# Packages alone first: they change less often than sources, and their layer is kept.
COPY scripts/install_dependencies.sh scripts/
RUN scripts/install_dependencies.sh
COPY . .
RUN scripts/build.sh package alidade alidade_pages
RUN cd build-package && cpack -G DEB -D CPACK_COMPONENTS_ALL=runtime -B /packages

FROM debian:12-slim
RUN --mount=type=bind,from=build,source=/packages,target=/packages \
    apt-get update -qq \
    && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends /packages/alidade_*.deb \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /data
ENTRYPOINT ["alidade"]
CMD ["help"]
